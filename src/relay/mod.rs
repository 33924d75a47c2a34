//! Relays: scenes of any number of people who hand boxes on along a curve, while others get in their way.
//!
//! Carriers stand along the curve in a zigzag. Each takes a box out of the hands of the one before, face to face, turns, carries
//! it to the next and holds it out. Boxes start at equal distances; who starts one hands it on, walks back, and puts the box
//! before it down where that one ends. So every neighbour hands something to the next, and the whole is one chain, however
//! many boxes there are. Everything is laid out such that little is left to the edit: turns to the nearest 5 degrees, for every
//! way a walk of the nearest length. Who gets in the way of one keeps out of all others.
//!
//! Same arguments, same bytes: nothing depends on a clock, and what is left to chance is a function of the seed and of who it
//! is about, so that neighbours keep theirs when others come or go.
//!
//! Source: the relay of Kim, Hyun, Kim, Lee, *Synchronized Multi-Character Motion Editing*, SIGGRAPH 2009, figure 1.

pub mod acts;
pub mod chance;
pub mod courses;
pub mod curve;
pub mod disturbers;
pub mod drawing;
pub mod layout;
pub mod points;
pub mod strung;
pub mod style;
pub mod ways;
pub mod write;

use crate::geometry::c64;
use disturbers::Clash;

/// What is to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct Relay {
    /// Everybody: carriers and disturbers.
    pub characters: usize,
    /// Those of them who get in the way; `None`: as many pairs as there are pairs of carriers, about.
    pub disturbers: Option<usize>,
    /// Boxes handed on at the same time, each from where it stands to where the next one stood.
    pub boxes: usize,
    /// Metres along the curve from one hand-over to the next; `None`: as the curve asks for, else [`SPACING`].
    pub spacing: Option<f64>,
    /// The shortest and the tallest body, metres.
    pub heights: (f64, f64),
    /// Seconds by which beginnings differ, and by which disturbers come early or late.
    pub phase: f64,
    /// How disturbers disturb; chosen among these.
    pub disturbances: Vec<Disturbance>,
    /// Whether frames may come and go when the scene is dragged.
    pub discrete: bool,
    /// Metres by which the end is dragged on, straight ahead of the last carrier; `None`: nothing is dragged.
    pub drag: Option<f64>,
    /// Of all choices.
    pub seed: u64,
    /// Where.
    pub along: Along,
}

/// Of whom a box is for all, where nobody says how many there are.
const CHARACTERS_PER_BOX: usize = 10;

impl Relay {
    /// That of `characters` along a line as the command writes it where nothing else is asked for: a box for every ten of them.
    pub fn of(characters: usize) -> Self {
        let plain = Self {
            characters,
            disturbers: None,
            boxes: 1,
            spacing: None,
            heights: (1.64, 1.86),
            phase: 0.3,
            disturbances: Disturbance::ALL.to_vec(),
            discrete: false,
            drag: None,
            seed: 1,
            along: Along::Line,
        };
        Self { boxes: plain.usual_boxes(), ..plain }
    }

    /// A box for every ten characters, as far as carriers can start them. Where there are too few carriers for any box, that is told
    /// when the scene is written.
    pub fn usual_boxes(&self) -> usize {
        let most = counts(self).map_or(1, |(carriers, _)| most_boxes(carriers));
        (self.characters / CHARACTERS_PER_BOX).clamp(1, most)
    }
}

/// The curve.
#[derive(Clone, Debug, PartialEq)]
pub enum Along {
    /// Straight along x.
    Line,
    /// Once round, counter-clockwise.
    Circle,
    /// Outwards, counter-clockwise, turns [`curve::TURNS_APART`] apart.
    Spiral,
    /// Through these plan points, metres.
    Points(Vec<c64>),
    /// Shaped like these plan points, as long as needed.
    Drawing(Vec<c64>),
}

/// A way of getting in the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Disturbance {
    /// Stands in the carrier's way and steps aside just in time.
    Aside,
    /// Jumps over a hurdle beside the carrier.
    Jump,
    /// Pats who waits for the box on the back.
    Pat,
}

impl Disturbance {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Aside, Self::Jump, Self::Pat];

    /// As on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Aside => "aside",
            Self::Jump => "jump",
            Self::Pat => "pat",
        }
    }
}

/// Metres from one hand-over to the next where nobody asks for more: about the shortest walk that sets off and halts.
pub const SPACING: f64 = 3.3;

/// Metres from one hand-over to the next: two arms' lengths and two steps, and a minute's walk.
pub const SPACINGS: (f64, f64) = (3.0, 60.0);

/// Most characters of a relay.
pub const MOST_CHARACTERS: usize = 100_000;

/// Statures of generated bodies whose hands still meet: those of adults, metres.
pub const HEIGHTS: (f64, f64) = (1.5, 2.0);

/// Longest phase, seconds: what waiting takes up.
pub const LONGEST_PHASE: f64 = 1.0;

/// Farthest that the end is dragged, metres: about what the last carrier and those before it can walk on.
pub const FARTHEST_DRAG: f64 = 60.0;

/// Fewest carriers for each box: the box before it comes when who started one is back.
pub const FEWEST_PER_BOX: usize = 3;

/// Why there is no such relay.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RelayError {
    /// Nobody to hand anything to, or more than a scene should hold.
    #[error("a relay is of 2 to {MOST_CHARACTERS} characters, not {0}")]
    Characters(usize),
    /// Disturbers leave too few carriers, or outnumber them.
    #[error(
        "{disturbers} disturbers leave {carriers} carriers: there must be 2 at least, and one for each disturber"
    )]
    Disturbers {
        /// Asked for.
        disturbers: usize,
        /// What is left.
        carriers: usize,
    },
    /// More boxes than carriers can start.
    #[error(
        "{carriers} carriers hand on at least one box and at most {most}, {FEWEST_PER_BOX} carriers for each but a single one, not {boxes}"
    )]
    Boxes {
        /// Asked for.
        boxes: usize,
        /// There are so many.
        carriers: usize,
        /// What is possible.
        most: usize,
    },
    /// Hand-overs too near or too far.
    #[error("a spacing of {0:.3} m is outside {least} to {most} m", least = SPACINGS.0, most = SPACINGS.1)]
    Spacing(f64),
    /// The curve ends before the relay does.
    #[error(
        "the curve is {length:.2} m long: {carriers} carriers {spacing:.2} m apart need {needed:.2} m; it holds {fit}"
    )]
    TooShort {
        /// Of the curve, metres.
        length: f64,
        /// There are so many.
        carriers: usize,
        /// Asked for, metres.
        spacing: f64,
        /// What they need, metres.
        needed: f64,
        /// Carriers for whom there is room.
        fit: usize,
    },
    /// The curve's own spacing is no good.
    #[error("{carriers} carriers on a curve of {length:.2} m are {spacing:.3} m apart, which is outside {least} to {most} m", least = SPACINGS.0, most = SPACINGS.1)]
    Stretched {
        /// Of the curve, metres.
        length: f64,
        /// There are so many.
        carriers: usize,
        /// What comes of it, metres.
        spacing: f64,
    },
    /// The circle is too small to stand on.
    #[error("a circle of {carriers} carriers has a radius of {radius:.2} m: they would stand in each other's way below {least} m", least = curve::SMALLEST_RADIUS)]
    Tight {
        /// There are so many.
        carriers: usize,
        /// What comes of it, metres.
        radius: f64,
    },
    /// No curve at all.
    #[error("the curve has no length")]
    NoCurve,
    /// Too far from the origin for a scene.
    #[error("the relay would reach {0:.0} m from the origin, more than a scene may hold")]
    TooFar(f64),
    /// Bodies out of range, or the shortest above the tallest.
    #[error("heights from {from} to {to} m are not within {least} to {most} m, the shorter first", from = .0.0, to = .0.1, least = HEIGHTS.0, most = HEIGHTS.1)]
    Heights((f64, f64)),
    /// Too much or nothing.
    #[error("a phase of {0} s is outside 0 to {LONGEST_PHASE} s")]
    Phase(f64),
    /// Dragged nowhere, backwards or too far.
    #[error("a drag of {0} m is outside 0.1 to {FARTHEST_DRAG} m")]
    Drag(f64),
    /// Disturbers without a way to disturb.
    #[error("there are disturbers, but no way for them to disturb")]
    NoDisturbance,
}

impl RelayError {
    /// What to do about it.
    pub const fn help(&self) -> &'static str {
        match self {
            Self::Characters(_) => "ask for another number of --characters",
            Self::Disturbers { .. } => "ask for fewer --disturbers, or for more --characters",
            Self::Boxes { boxes: 0, .. } => "leave --boxes out, or ask for one at least",
            Self::Boxes { .. } => "ask for fewer --boxes, or for fewer --disturbers",
            Self::Spacing(_) => "ask for another --spacing",
            Self::TooShort { .. } => {
                "ask for fewer --characters or a smaller --spacing, or leave --spacing out"
            }
            Self::Stretched { .. } => "ask for another number of --characters, or draw another curve",
            Self::Tight { .. } => "ask for more --characters, fewer --disturbers or a larger --spacing",
            Self::NoCurve => "draw a curve of two different points at least",
            Self::TooFar(_) => "draw the curve nearer to the origin, or ask for fewer --characters",
            Self::Heights(_) => "write --heights 1.64..1.86",
            Self::Phase(_) => "ask for another --phase",
            Self::Drag(_) => "ask for another --drag",
            Self::NoDisturbance => "name one --disturbance at least, or ask for --disturbers 0",
        }
    }
}

/// The scene file of a relay. `command`: what its head says it was written by. Cost: linear in characters.
///
/// # Errors
/// [`RelayError`] where the numbers do not fit each other or the curve.
pub fn relay(relay: &Relay, command: &str) -> Result<String, RelayError> {
    Ok(relay_with_clashes(relay, command)?.0)
}

/// The same, and who are in each other's way in it: curves that cross themselves, or come back to where they were, lead people through
/// people. In the order of who they are: carriers along the curve, then disturbers, each with those after them.
///
/// # Errors
/// As [`relay`].
pub fn relay_with_clashes(relay: &Relay, command: &str) -> Result<(String, Vec<String>), RelayError> {
    let layout = layout::layout(relay)?;
    let name = |who: usize| match who.checked_sub(layout.carriers.len()) {
        None => format!("carrier {}", who + 1),
        Some(index) => format!("disturber {}", index + 1),
    };
    let tell = |clash: &Clash| {
        let (one, other) = clash.who;
        let Clash { depth, time, .. } = clash;
        format!("{} and {} are in each other by {depth:.2} m at {time:.1} s", name(one), name(other))
    };
    let clashes = layout.clashes.iter().map(tell).collect();
    Ok((write::scene(relay, &layout, command), clashes))
}

/// How many carry, and how many get in the way.
///
/// # Errors
/// [`RelayError::Characters`], [`RelayError::Disturbers`].
pub fn counts(relay: &Relay) -> Result<(usize, usize), RelayError> {
    let all = relay.characters;
    if !(2..=MOST_CHARACTERS).contains(&all) {
        return Err(RelayError::Characters(all));
    }
    // Two carriers and two disturbers make a group; who is left over carries.
    let disturbers = relay.disturbers.unwrap_or(all / 4 * 2);
    let carriers = all.saturating_sub(disturbers);
    if carriers < 2 || disturbers > carriers {
        return Err(RelayError::Disturbers { disturbers, carriers });
    }
    Ok((carriers, disturbers))
}

/// Boxes that as many carriers can hand on at the same time.
pub const fn most_boxes(carriers: usize) -> usize {
    let most = carriers / FEWEST_PER_BOX;
    if most == 0 { 1 } else { most }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The spiral of 78.
    pub(crate) fn spiral() -> Relay {
        Relay { boxes: 8, along: Along::Spiral, ..Relay::of(78) }
    }

    #[test]
    fn two_of_four_get_in_the_way_unless_told() {
        let counted = |characters| counts(&Relay { characters, ..spiral() });
        assert_eq!(counted(78), Ok((40, 38)));
        assert_eq!(counted(10), Ok((6, 4)));
        assert_eq!(counted(3), Ok((3, 0)));
        assert!(counted(1).is_err() && counted(MOST_CHARACTERS + 1).is_err());
        assert!(counts(&Relay { disturbers: Some(40), ..spiral() }).is_err());
    }

    #[test]
    fn who_are_led_through_each_other_are_told() {
        let clashes = |asked: Relay| relay_with_clashes(&asked, "").expect("it fits").1;
        assert_eq!(clashes(spiral()), [""; 0]);
        // The innermost turn of the spiral is shorter than two ways.
        let wide = Relay { characters: 4, boxes: 1, spacing: Some(60.0), ..spiral() };
        assert_eq!(clashes(wide), ["carrier 1 and carrier 2 are in each other by 0.13 m at 15.5 s"]);
        let there_and_back = [(0.0, 0.0), (30.0, 0.0), (30.0, 1.0), (0.0, 1.0)];
        let along = Along::Points(there_and_back.map(|(x, y)| c64::new(x, y)).to_vec());
        let back = clashes(Relay { characters: 24, boxes: 2, along, ..spiral() });
        assert!(back.iter().any(|told| told.starts_with("carrier 1 and carrier 12 ")), "{back:?}");
    }

    #[test]
    fn every_misfit_is_an_error() {
        let error = |spoiled: Relay| relay(&spoiled, "").expect_err("it does not fit");
        assert!(matches!(error(Relay { boxes: 14, ..spiral() }), RelayError::Boxes { most: 13, .. }));
        assert!(matches!(error(Relay { boxes: 0, ..spiral() }), RelayError::Boxes { .. }));
        assert!(matches!(error(Relay { heights: (1.9, 1.7), ..spiral() }), RelayError::Heights(_)));
        assert!(matches!(error(Relay { heights: (f64::NAN, 1.7), ..spiral() }), RelayError::Heights(_)));
        assert!(matches!(error(Relay { phase: 9.0, ..spiral() }), RelayError::Phase(_)));
        assert!(matches!(error(Relay { drag: Some(0.0), ..spiral() }), RelayError::Drag(_)));
        assert!(matches!(error(Relay { spacing: Some(f64::NAN), ..spiral() }), RelayError::Spacing(_)));
        assert!(matches!(error(Relay { disturbances: vec![], ..spiral() }), RelayError::NoDisturbance));
        let far = Relay { characters: 60_000, spacing: Some(3.5), along: Along::Line, ..spiral() };
        assert!(matches!(error(far), RelayError::TooFar(_)));
    }
}
