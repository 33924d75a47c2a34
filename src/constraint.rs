//! What must hold: the constraint vocabulary of scenes.

use crate::geometry::{c64, lerp_angle};
use crate::index::{CharacterId, ConstraintId, ObjectId};

/// Weight of a soft constraint whose author gives none; over an interval, weight of each of its working frames.
pub const DEFAULT_WEIGHT: f64 = 10.0;

/// A named instant of one character's track. It follows the frame it names through stringing and every discrete edit.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// Whose.
    pub character: CharacterId,
    /// Which frame.
    pub instant: Instant,
    /// As people read and write it: `ann/slap:hit`.
    pub name: String,
}

/// Frame that a moment names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Instant {
    /// First frame of the track.
    TrackStart,
    /// Last frame of the track.
    TrackEnd,
    /// First frame on the track of the clip at position `.0` of the character's `track` list.
    ClipStart(usize),
    /// Last frame on the track of the clip at position `.0` of the character's `track` list.
    ClipEnd(usize),
    /// A frame of the clip at position `entry` of the character's `track` list.
    Frame {
        /// Position in the `track` list, from 0.
        entry: usize,
        /// Working frame of that clip (`WorkingClip::working_frame` of the file's frame), a fraction where rates differ.
        working: f64,
    },
    /// This track frame: where discrete edits have brought a moment of one of the other kinds.
    Shown(f64),
}

/// When a constraint holds.
#[derive(Clone, Debug, PartialEq)]
pub enum When {
    /// At one moment.
    At(Moment),
    /// From the first moment to the second, both of one character.
    During(Moment, Moment),
}

/// How strongly a constraint holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Strength {
    /// Exactly.
    Hard,
    /// As a spring of this weight, energy `½·w·|residual|²`; at an instant in all, over an interval per working frame.
    Soft(f64),
}

impl Default for Strength {
    fn default() -> Self {
        Self::Soft(DEFAULT_WEIGHT)
    }
}

/// Whom a relative constraint refers to.
#[derive(Clone, Debug, PartialEq)]
pub enum Partner {
    /// Another character, at a moment (or over an interval) of its own.
    Character(When),
    /// An object.
    Object(ObjectId),
}

/// A quantity of a relative constraint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Relation<T> {
    /// This value.
    Given(T),
    /// The value before the edit, sample by sample over an interval.
    AsBefore,
    /// Not held.
    Free,
}

/// Values of a relative constraint before all discrete changes, at shares of its interval from 0 to 1, rising; one at an
/// instant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Captured {
    /// Shares of the interval.
    pub shares: Vec<f64>,
    /// Ahead + i·left of the partner, metres.
    pub offsets: Vec<c64>,
    /// Facing minus the partner's, radians.
    pub facings: Vec<f64>,
}

impl Captured {
    /// Offset and facing at a share of the interval, on straight lines between those known; of facings on the shorter arc.
    pub fn at(&self, share: f64) -> (c64, f64) {
        let next = self.shares.partition_point(|known| *known <= share);
        let (low, high) = (next.saturating_sub(1), next.min(self.shares.len() - 1));
        let width = self.shares[high] - self.shares[low];
        let s = if width > 0.0 { (share - self.shares[low]) / width } else { 0.0 };
        let offset = self.offsets[low] + s * (self.offsets[high] - self.offsets[low]);
        (offset, lerp_angle(self.facings[low], self.facings[high], s))
    }
}

/// What must hold.
#[derive(Clone, Debug, PartialEq)]
pub enum ConstraintKind {
    /// Where somebody is, and how they face.
    Pin {
        /// When.
        when: When,
        /// Ground plan, metres.
        position: Option<c64>,
        /// Body facing, radians.
        facing: Option<f64>,
    },
    /// Where somebody is, and how they face, relative to somebody else or to an object.
    Relative {
        /// When; an interval needs an interval of the partner.
        when: When,
        /// To whom.
        partner: Partner,
        /// Ahead + i·left of the partner's body (or object) facing, metres.
        offset: Relation<c64>,
        /// Facing minus the partner's facing, radians.
        facing: Relation<f64>,
    },
    /// When a moment happens.
    Time {
        /// Which.
        at: Moment,
        /// Scene time, seconds.
        seconds: f64,
    },
    /// How long something takes.
    Duration {
        /// Beginning.
        from: Moment,
        /// End, of the same character.
        to: Moment,
        /// Time of `to` minus time of `from`, seconds.
        seconds: f64,
    },
    /// Moments, or intervals, of several characters that happen together.
    Sync {
        /// Two or more, all instants or all intervals; each is tied to the first.
        moments: Vec<When>,
        /// Time of the first minus time of the second, seconds; 0 unless there are just two.
        offset: f64,
    },
}

/// One constraint of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraint {
    /// Its author's name for it, or `pin[0]`, `sync[2]` … in the order of the file.
    pub name: String,
    /// Line of the scene file, from 1; 0 where the scene does not come from a file.
    pub line: u32,
    /// How strongly.
    pub strength: Strength,
    /// What.
    pub kind: ConstraintKind,
}

/// Where a constraint's target is dragged to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// Ground point of a pin, metres.
    Position(c64),
    /// Facing of a pin, or relative facing, radians.
    Facing(f64),
    /// Offset of a relative constraint, ahead + i·left, metres.
    Offset(c64),
    /// Time, duration, or offset of a synchronisation, seconds.
    Seconds(f64),
}

/// A handle that is pulled in equal steps, one update each, from where it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Drag {
    /// As the file names it: a moment or a constraint.
    pub handle: String,
    /// Constraints whose targets move, and where each goes.
    pub targets: Vec<(ConstraintId, Target)>,
    /// At least 1.
    pub steps: usize,
}

/// Types of discrete changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ChangeKind {
    /// Frames are taken out.
    Delete,
    /// Frames are shown twice.
    Duplicate,
    /// Frames from elsewhere are put in.
    Insert,
    /// Frames give way to others.
    Replace,
}

/// How candidates for discrete changes are weighed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Evaluator {
    /// Exactly, in rising order of a lower bound, until what is left cannot win.
    #[default]
    Exact,
    /// Exactly, all of them: the same choice for more work.
    BruteForce,
    /// All of them on every 25th frame and those that matter, as published; the best one exactly.
    Subsampled,
}

/// What discrete editing may do in a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Discrete {
    /// Types that may happen.
    pub kinds: Vec<ChangeKind>,
    /// Whose tracks may change; `None`: everybody's.
    pub characters: Option<Vec<CharacterId>>,
    /// Intervals within which tracks may change, those of a character from its first to its second moment; `None`:
    /// everywhere.
    pub times: Option<Vec<(Moment, Moment)>>,
    /// Rectangles of the ground plan, by opposite corners, metres, in which tracks may change before the edit; `None`:
    /// everywhere.
    pub regions: Option<Vec<(c64, c64)>>,
    /// How candidates are weighed.
    pub evaluator: Evaluator,
    /// Whether changes go on after the last drag, until none is worth it.
    pub settle: bool,
    /// Whether what comes of a drag depends on the motion at rest and where the handles are, not on the way they took.
    pub reversible: bool,
}

impl ChangeKind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Delete, Self::Duplicate, Self::Insert, Self::Replace];

    /// As scenes and reports name it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Delete => "delete",
            Self::Duplicate => "duplicate",
            Self::Insert => "insert",
            Self::Replace => "replace",
        }
    }
}

impl Default for Discrete {
    fn default() -> Self {
        Self {
            kinds: ChangeKind::ALL.to_vec(),
            characters: None,
            times: None,
            regions: None,
            evaluator: Evaluator::default(),
            settle: true,
            reversible: false,
        }
    }
}

impl When {
    /// The character whose moment or interval this is.
    pub fn character(&self) -> CharacterId {
        match self {
            Self::At(moment) | Self::During(moment, _) => moment.character,
        }
    }

    /// The moments it names.
    pub fn moments(&self) -> Vec<&Moment> {
        match self {
            Self::At(moment) => vec![moment],
            Self::During(from, to) => vec![from, to],
        }
    }

    /// The moments it names, to be changed.
    pub fn moments_mut(&mut self) -> Vec<&mut Moment> {
        match self {
            Self::At(moment) => vec![moment],
            Self::During(from, to) => vec![from, to],
        }
    }
}

impl Target {
    /// What it moves, in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Position(_) => "position",
            Self::Facing(_) => "facing",
            Self::Offset(_) => "offset",
            Self::Seconds(_) => "time",
        }
    }
}

impl ConstraintKind {
    /// Name of the kind in scene files and reports.
    pub fn keyword(&self) -> &'static str {
        match self {
            Self::Pin { .. } => "pin",
            Self::Relative { .. } => "relative",
            Self::Time { .. } => "time",
            Self::Duration { .. } => "duration",
            Self::Sync { .. } => "sync",
        }
    }

    /// Every moment the constraint names, in the order of the file.
    pub fn moments(&self) -> Vec<&Moment> {
        match self {
            Self::Pin { when, .. } => when.moments(),
            Self::Relative { when, partner: Partner::Character(other), .. } => {
                when.moments().into_iter().chain(other.moments()).collect()
            }
            Self::Relative { when, .. } => when.moments(),
            Self::Time { at, .. } => vec![at],
            Self::Duration { from, to, .. } => vec![from, to],
            Self::Sync { moments, .. } => moments.iter().flat_map(When::moments).collect(),
        }
    }

    /// Whether one of these moments is of a character.
    pub fn names(&self, who: CharacterId) -> bool {
        let own = |moment: &Moment| moment.character == who;
        let names = |when: &When| match when {
            When::At(moment) => own(moment),
            When::During(from, to) => own(from) || own(to),
        };
        match self {
            Self::Pin { when, .. } => names(when),
            Self::Relative { when, partner, .. } => {
                names(when) || matches!(partner, Partner::Character(other) if names(other))
            }
            Self::Time { at, .. } => own(at),
            Self::Duration { from, to, .. } => own(from) || own(to),
            Self::Sync { moments, .. } => moments.iter().any(names),
        }
    }

    /// Every moment the constraint names, to be changed.
    pub fn moments_mut(&mut self) -> Vec<&mut Moment> {
        match self {
            Self::Pin { when, .. } => when.moments_mut(),
            Self::Relative { when, partner: Partner::Character(other), .. } => {
                when.moments_mut().into_iter().chain(other.moments_mut()).collect()
            }
            Self::Relative { when, .. } => when.moments_mut(),
            Self::Time { at, .. } => vec![at],
            Self::Duration { from, to, .. } => vec![from, to],
            Self::Sync { moments, .. } => moments.iter_mut().flat_map(When::moments_mut).collect(),
        }
    }
}
