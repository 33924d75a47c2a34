//! What a scene file says, word for word: one type per table, with the docs that editors show.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use toml::de::DeValue;

use crate::scene::group::Groups;
use crate::scene::manipulation::{Discrete, Drag};
use crate::scene::report::{At, Report};
use crate::scene::things::{Carry, EndEffector, FullBody, Object};
use crate::scene::tree::{Field, Keys, Node, Read, table, wrong_type};
use crate::scene::unavailable::Physics;
use crate::scene::values::{
    Mode, Named, Offset, OneOrPair, Pair, RelativeFacing, Strength, Tables, Turning, Unit, Up,
};

table! {
    /// A choreography: who performs which clips, what must hold, and which stages run.
    Scene {
        required {}
        optional {
            /// For people.
            title: String,
            /// Rate of the result, frames per second (30 if left out).
            #[schemars(range(max = 1000))]
            fps: f64,
            /// Which column of settings holds ("production" if left out).
            mode: Mode,
            /// Name = source of every clip that tracks use.
            clips: Named<Clip>,
            /// Who performs.
            character: Tables<Character>,
            /// Things that stand in the scene, or are carried.
            object: Tables<Object>,
            /// Where somebody is, and how they face.
            pin: Tables<Pin>,
            /// Where somebody is relative to somebody else or to an object.
            relative: Tables<Relative>,
            /// Who has an object when.
            carry: Tables<Carry>,
            /// Where a hand or foot is.
            end_effector: Tables<EndEffector>,
            /// When a moment happens.
            time: Tables<Time>,
            /// How long something takes.
            duration: Tables<Duration>,
            /// What happens together.
            sync: Tables<Sync>,
            /// Scripted manipulation, in order.
            drag: Tables<Drag>,
            /// Insertion and removal of steps.
            discrete: Discrete,
            /// Bounds on the time warp.
            warp: Warp,
            /// Physical plausibility.
            physics: Physics,
            /// Feet and hands of the whole body.
            full_body: FullBody,
            /// Tables written once and meant once for every row.
            group: Groups,
        }
    }
}

/// Where a clip comes from: "FILE", "mocap:FILE", "builtin:NAME", or a table.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(untagged)]
pub enum Clip {
    /// A file relative to the scene file, `mocap:` and a file below $COTILLION_MOCAP, or `builtin:` and a generated clip.
    Source(String),
    /// A file, and how to read it.
    File(Box<FileClip>),
    /// A generated clip.
    Builtin(Box<BuiltinClip>),
    /// Another clip of `[clips]`, bent or tilted.
    Derived(Box<DerivedClip>),
    /// Two other clips of `[clips]`, one going over into the other.
    Blended(Box<BlendedClip>),
    /// Something else, already reported; the name of the clip stays known.
    #[schemars(skip)]
    Spoiled,
}

impl Read for Clip {
    fn read(node: &Node<'_>, report: &mut Report) -> Option<Self> {
        match node.value {
            DeValue::String(_) => String::read(node, report).map(Self::Source),
            DeValue::Table(keys) if keys.contains_key("builtin") => {
                let clip = BuiltinClip::read(node, report)?;
                Some(Self::Builtin(Box::new(clip)))
            }
            DeValue::Table(keys) if keys.contains_key("from") => {
                let clip = DerivedClip::read(node, report)?;
                Some(Self::Derived(Box::new(clip)))
            }
            DeValue::Table(keys) if keys.contains_key("blend") => {
                let clip = BlendedClip::read(node, report)?;
                Some(Self::Blended(Box::new(clip)))
            }
            DeValue::Table(_) => {
                let clip = FileClip::read(node, report)?;
                Some(Self::File(Box::new(clip)))
            }
            _ => {
                wrong_type(
                    node,
                    "a file name in quotes, or a table with \"file\", \"builtin\", \"from\" or \"blend\"",
                    report,
                );
                Some(Self::Spoiled)
            }
        }
    }
}

table! {
    /// A file, and how to read it.
    FileClip {
        required {
            /// File relative to the scene file, or `mocap:` and a file below $COTILLION_MOCAP.
            file: String,
        }
        optional {
            /// First and last frame to use: the file's own, from 0, both included.
            frames: Pair<u32>,
            /// Named frames: the file's own, from 0.
            events: Named<u32>,
            /// Contacts of hands, which are not found, and of feet in place of those that are.
            contacts: Tables<Contact>,
            /// Frames per second, where the file is wrong about it.
            #[schemars(range(max = 1000))]
            fps: f64,
            /// Unit of length, where the file is silent.
            unit: Unit,
            /// The axis that points up, where the file is silent.
            up: Up,
            /// Skeleton (ASF) of a motion (AMC); left out: the `.asf` beside it whose name its own starts with.
            skeleton: String,
            /// Joints of roles, by their names in the file, where names and tree tell it wrong: `{ left_hand = "LeftWrist" }`.
            roles: Named<String>,
            /// Whether what would only be warned of is refused.
            strict: bool,
            /// Whether single frames that are no numbers or cannot be motion are filled in.
            repair: bool,
        }
    }
}

table! {
    /// Another clip of `[clips]`, its frames laid elsewhere: bent, then tilted. Its range, events and contacts stay.
    DerivedClip {
        required {
            /// Name of the other clip.
            from: String,
        }
        optional {
            /// Its way, laid onto an arc.
            bend: Bend,
            /// It is turned as a whole about the sideways axis: degrees, uphill positive.
            #[schemars(range(min = -60, max = 60))]
            tilt: f64,
            /// First and last frame to use, as the other counts them, both included.
            frames: Pair<u32>,
            /// Named frames, besides those of the other.
            events: Named<u32>,
            /// Contacts, besides those of the other.
            contacts: Tables<Contact>,
        }
    }
}

table! {
    /// An arc that a way is laid onto.
    Bend {
        required {
            /// Metres.
            #[schemars(range(max = 100_000))]
            radius: f64,
        }
        optional {
            /// "left" (if left out) or "right".
            to: Turning,
        }
    }
}

table! {
    /// The first clip up to its last cycle, which goes over into the first cycle of the second, then the rest of that.
    BlendedClip {
        required {
            /// Names of two other clips of `[clips]`, of the same body at the same rate.
            blend: Pair<String>,
        }
        optional {
            /// First and last frame to use, counted from 0 at the first of the blend, both included.
            frames: Pair<u32>,
            /// Named frames, counted likewise.
            events: Named<u32>,
            /// Contacts, counted likewise.
            contacts: Tables<Contact>,
        }
    }
}

table! {
    /// When a hand or foot bears.
    Contact {
        required {
            /// A role (left_hand, right_foot, left_toe; a foot is its heel), or a joint by its name in the file.
            joint: String,
            /// First frame: the file's own, from 0.
            from: u32,
            /// Last frame, included.
            to: u32,
        }
        optional {}
    }
}

/// A generated clip; every further key is a parameter of it.
#[derive(Clone, Debug, JsonSchema)]
pub struct BuiltinClip {
    /// Which one.
    pub builtin: Field<String>,
    /// First and last frame to use, from 0, both included.
    #[schemars(default)]
    pub frames: Field<Pair<u32>>,
    /// Named frames, from 0, besides its own.
    #[schemars(default)]
    pub events: Field<Named<u32>>,
    /// Contacts of hands, which are not found, and of feet in place of those that are.
    #[schemars(default)]
    pub contacts: Field<Tables<Contact>>,
    /// Parameters of the generated clip.
    #[schemars(flatten, with = "BTreeMap<String, f64>")]
    pub parameters: BTreeMap<String, At<f64>>,
}

impl Read for BuiltinClip {
    fn read(node: &Node<'_>, report: &mut Report) -> Option<Self> {
        let mut keys = Keys::of(node, report)?;
        Some(Self {
            builtin: keys.required("builtin"),
            frames: keys.optional("frames"),
            events: keys.optional("events"),
            contacts: keys.optional("contacts"),
            parameters: keys.remaining(),
        })
    }
}

table! {
    /// Somebody who performs.
    Character {
        required {
            /// Unique among characters and objects, without `/`, `:` and `#`.
            name: String,
            /// Clips strung on one time track, by name.
            track: Vec<At<String>>,
        }
        optional {
            /// Where the track starts before the edit, metres `[x, -z]`; left out: where the clip has it.
            position: Pair<f64>,
            /// Where the body looks there, degrees counter-clockwise from +x seen from above; left out: as in the clip.
            facing: f64,
            /// A clip of `[clips]` whose body this is; left out: the body of the track's first clip. Clips of other bodies are
            /// performed by this one.
            skeleton: String,
        }
    }
}

table! {
    /// Where somebody is, and how they face.
    Pin {
        required {}
        optional {
            /// For reports and drags.
            name: String,
            /// The moment: `ann:start`, `ann/slap:hit`, `ann/walk#2:57`.
            at: String,
            /// An interval in place of a moment: its first and last moment, of one character.
            during: Pair<String>,
            /// Metres on the ground plan, `[x, -z]`; left out: not held.
            position: Pair<f64>,
            /// Degrees counter-clockwise from +x seen from above; left out: not held.
            facing: f64,
            /// "hard", or a weight; left out: soft with the default weight.
            strength: Strength,
        }
    }
}

table! {
    /// Where somebody is relative to somebody else or to an object.
    Relative {
        required {
            /// A moment (or a pair of moments, with `during`) of somebody else, or the name of an object.
            to: OneOrPair,
        }
        optional {
            /// For reports and drags.
            name: String,
            /// The moment.
            at: String,
            /// An interval in place of a moment: its first and last moment, of one character.
            during: Pair<String>,
            /// Metres ahead and to the left of the partner; left out: as before the edit; "free": not held.
            offset: Offset,
            /// Degrees from the partner's facing; left out: not held; "rest": as before the edit.
            facing: RelativeFacing,
            /// "hard", or a weight; left out: soft with the default weight.
            strength: Strength,
        }
    }
}

table! {
    /// When a moment happens.
    Time {
        required {
            /// The moment.
            at: String,
            /// Scene time.
            seconds: f64,
        }
        optional {
            /// For reports and drags.
            name: String,
            /// "hard", or a weight; left out: soft with the default weight.
            strength: Strength,
        }
    }
}

table! {
    /// How long something takes.
    Duration {
        required {
            /// The moment at which it begins.
            from: String,
            /// The moment at which it ends, of the same character.
            to: String,
            /// How long.
            #[schemars(range(min = 0))]
            seconds: f64,
        }
        optional {
            /// For reports and drags.
            name: String,
            /// "hard", or a weight; left out: soft with the default weight.
            strength: Strength,
        }
    }
}

table! {
    /// Moments, or intervals, that happen together.
    Sync {
        required {}
        optional {
            /// For reports and drags.
            name: String,
            /// Two or more moments of different characters.
            moments: Vec<At<String>>,
            /// Two or more intervals of different characters, in place of moments.
            intervals: Vec<At<Pair<String>>>,
            /// Of two: time of the first minus time of the second, seconds.
            offset: f64,
            /// "hard", or a weight; left out: soft with the default weight.
            strength: Strength,
        }
    }
}

table! {
    /// Bounds on the time warp, as multiples of the original step.
    Warp {
        required {}
        optional {
            /// Smallest step, above 0 and at most 1.
            #[schemars(range(max = 1))]
            min_step: f64,
            /// Largest step, at least 1.
            #[schemars(range(min = 1))]
            max_step: f64,
        }
    }
}
