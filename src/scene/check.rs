//! Turns what a scene file says into a sound [`Scene`], reporting every fault on the way.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use crate::clip::working::WorkingClip;
use crate::constraint::Instant;
use crate::geometry::c64;
use crate::object::Object;
use crate::scene::bodies::Bodies;
use crate::scene::busy::Performers;
use crate::scene::checker::{Checked, check_intervals, plan_point};
use crate::scene::clips::{self, ClipFolders, Declared, Folders, check_name, within};
use crate::scene::constraints;
use crate::scene::derived;
use crate::scene::moment::{Entry, Member};
use crate::scene::report::{At, Lines, Place, Report};
use crate::scene::tree::Field;
use crate::scene::values;
use crate::scene::{Character, FullBody, Mode, Plants, Scene, Warp, busy, drags, objects, raw, things, ties};
use crate::track::{Protected, SeamChoice, SeamRule, Track};

/// The scene that `raw` describes; whatever is wrong with it is in `report`, and the scene is then of no use.
///
/// `path`: of the scene file. `lines`: of its text.
pub fn check(
    raw: &raw::Scene,
    path: &Path,
    lines: &Lines<'_>,
    folders: &ClipFolders,
    report: &mut Report,
) -> Scene {
    let folder = path.parent().unwrap_or(Path::new(""));
    let folders = Folders { scene: folder, mocap: folders.mocap.as_deref() };
    let clips = clips::declared(raw, folders, report);
    let cast = cast(raw, &clips, report);
    let objects = objects::objects(raw, report);
    check_unique(raw, report);
    let mut checked = match raw.character {
        Field::Spoiled => Checked::default(),
        _ => constraints::check(raw, &cast, lines, report),
    };
    ties::warn_of_untied(&checked, &cast, report);
    objects::check_order(&checked, &cast, report);
    let characters = characters(raw, &cast, (&checked, &objects), report);
    let drags = drags::bind(&mut checked, &characters, cast.len());
    Scene {
        title: raw.title.value().cloned().unwrap_or_else(|| {
            path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
        }),
        fps: within(&raw.fps, 1000.0, "frames per second", report).unwrap_or(30.0),
        mode: mode(raw),
        characters,
        objects,
        constraints: checked.constraints,
        carries: checked.carries,
        end_effectors: checked.end_effectors,
        drags,
        discrete: checked.discrete,
        physics: checked.physics,
        captured: BTreeMap::new(),
        warp: warp(&raw.warp, report),
        full_body: full_body(&raw.full_body),
    }
}

fn mode(raw: &raw::Scene) -> Mode {
    match raw.mode.value() {
        Some(values::Mode::Paper) => Mode::Paper,
        Some(values::Mode::Production) | None => Mode::Production,
    }
}

/// The published method aligns by the root.
fn seam_rule(mode: Mode) -> SeamRule {
    match mode {
        Mode::Paper => SeamRule::Root,
        Mode::Production => SeamRule::PlantedFeet,
    }
}

fn warp(field: &Field<raw::Warp>, report: &mut Report) -> Warp {
    let Some(warp) = field.value() else {
        return Warp::default();
    };
    let min_step = within(&warp.min_step, 1.0, "steps at least", report);
    let max_step = warp.max_step.given().map(|step| {
        if step.value < 1.0 {
            let message = format!("max_step = {} would forbid the original step", step.value);
            report.fault(&step.place, message, "write a number of at least 1");
        }
        step.value
    });
    Warp { min_step, max_step }
}

fn full_body(stage: &Field<things::FullBody>) -> FullBody {
    let default = FullBody::default();
    let Some(stage) = stage.value() else {
        return default;
    };
    FullBody {
        enabled: stage.enabled.value().copied().unwrap_or(default.enabled),
        plants: stage.plants.value().map_or(default.plants, plants),
    }
}

const fn plants(given: &values::Plants) -> Plants {
    match given {
        values::Plants::AsCaptured => Plants::AsCaptured,
        values::Plants::Pinned => Plants::Pinned,
        values::Plants::Whole => Plants::Whole,
    }
}

fn cast(raw: &raw::Scene, clips: &[Declared], report: &mut Report) -> Vec<Member> {
    let characters = raw.character.tables();
    if characters.is_empty() && !matches!(raw.character, Field::Spoiled) {
        let help = "add a [[character]] table with a name and a track of clips";
        report.fault(&Place::default(), "the scene has no character", help);
    }
    let mut used = vec![false; clips.len()];
    let mut bodies = Bodies::new(clips);
    let members = characters.iter().map(|character| {
        let mut member = member(&character.value, clips, &mut used, report);
        bodies.embody(&character.value, &mut member, &mut used, report);
        member
    });
    let cast = members.collect();
    derived::mark_parents(raw, clips, &mut used);
    clips::warn_of_unused(clips, &used, report);
    cast
}

fn member(character: &raw::Character, clips: &[Declared], used: &mut [bool], report: &mut Report) -> Member {
    if let Some(name) = character.name.given() {
        check_name(name, "character", report);
    }
    let mut member = Member {
        name: character.name.value().cloned().unwrap_or_default(),
        track: Vec::new(),
        track_is_known: true,
        performed: Vec::new(),
    };
    let Some(track) = character.track.given() else {
        member.track_is_known = false;
        return member;
    };
    if track.value.is_empty() {
        report.fault(&track.place, "the track is empty", "name at least one clip");
        member.track_is_known = false;
    }
    for At { value: name, place } in &track.value {
        match clips::find(name, clips) {
            Ok(clip) => {
                used[clip] = true;
                member.track.push(clips[clip].entry.clone());
            }
            Err(help) => {
                report.fault(place, format!("no clip \"{name}\""), help);
                member.track_is_known = false;
                let events = Arc::default();
                member.track.push(Entry { name: name.clone(), clip: None, events });
            }
        }
    }
    member
}

/// Reports characters and objects that share a name.
fn check_unique(raw: &raw::Scene, report: &mut Report) {
    let characters = raw.character.tables().iter().map(|character| (&character.value.name, "character"));
    let objects = raw.object.tables().iter().map(|object| (&object.value.name, "object"));
    let mut first: BTreeMap<&String, &str> = BTreeMap::new();
    for (name, kind) in characters.chain(objects) {
        let Some(At { value: name, place }) = name.given() else {
            continue;
        };
        if let Some(other) = first.get(name) {
            let message = format!("there already is a{} \"{name}\"", article(other));
            report.fault(place, message, format!("give this {kind} a name of its own"));
        } else {
            first.insert(name, kind);
        }
    }
}

fn article(noun: &str) -> String {
    let n = if noun.starts_with('o') { "n" } else { "" };
    format!("{n} {noun}")
}

/// Everybody whose track can be strung.
fn characters(
    raw: &raw::Scene,
    cast: &[Member],
    (checked, objects): (&Checked, &[Object]),
    report: &mut Report,
) -> Vec<Character> {
    let rule = seam_rule(mode(raw));
    let mut strung = Strung::new();
    let tracks: Vec<Option<Track>> = raw
        .character
        .tables()
        .iter()
        .zip(cast)
        .zip(protected(cast.len(), checked))
        .map(|((character, member), protected)| {
            track(&character.value, member, (&protected, rule), &mut strung, report)
        })
        .collect();
    check_intervals(checked, cast, &tracks, report);
    let performers = Performers { cast, tracks: &tracks };
    busy::check_hands(checked, &performers, report);
    busy::check_loads(checked, &performers, report);
    busy::warn_of_lonely(checked, objects, &performers, report);
    cast.iter()
        .zip(tracks)
        .filter_map(|(member, track)| {
            let (name, performed) = (member.name.clone(), member.performed.clone());
            track.map(|track| Character { name, track, performed })
        })
        .collect()
}

/// Frames that moments name, of each of `count` characters.
fn protected(count: usize, checked: &Checked) -> Vec<Vec<Protected>> {
    let mut frames = vec![Vec::new(); count];
    for moment in checked.moments() {
        if let Instant::Frame { entry, working } = moment.instant {
            frames[moment.character.as_usize()].push(Protected {
                entry,
                working,
                moment: moment.name.clone(),
            });
        }
    }
    frames
}

/// Clips strung so far, not yet placed: by the clips, which live as long as the scene is read, and by the frames that stay.
type Strung = BTreeMap<(Vec<usize>, Vec<(usize, u64)>), (Track, Vec<SeamChoice>)>;

/// Strings clips as [`Track::string`] does; what was strung before is only placed. Crowds perform the same few tracks.
fn string(
    clips: Vec<Arc<WorkingClip>>,
    protected: &[Protected],
    start: (Option<c64>, Option<f64>),
    rule: SeamRule,
    strung: &mut Strung,
) -> (Track, Vec<SeamChoice>) {
    let mut frames: Vec<_> = protected.iter().map(|frame| (frame.entry, frame.working.to_bits())).collect();
    frames.sort_unstable();
    frames.dedup();
    let key = (clips.iter().map(|clip| Arc::as_ptr(clip).addr()).collect(), frames);
    if let Some((track, seams)) = strung.get(&key) {
        // Warnings name the moments of the one they are about.
        if seams.iter().all(|seam| seam.distance <= seam.admissible) {
            let mut track = track.clone();
            track.place(start);
            return (track, seams.clone());
        }
    }
    let (track, seams) = Track::string(clips, protected, start, rule);
    strung.insert(key, (track.clone(), seams.clone()));
    (track, seams)
}

fn track(
    character: &raw::Character,
    member: &Member,
    (protected, rule): (&[Protected], SeamRule),
    strung: &mut Strung,
    report: &mut Report,
) -> Option<Track> {
    let position = character.position.given().map(|position| plan_point(position, report));
    let facing = character.facing.value().map(|degrees| degrees.to_radians());
    let places = character.track.given()?;
    let clips: Option<Vec<_>> = member.track.iter().map(|entry| entry.clip.clone()).collect();
    let clips = clips.filter(|clips| !clips.is_empty())?;
    // Bodies still differ only where the body's clip is at fault, which is already reported.
    let skeleton = &clips[0].clip.skeleton;
    if !clips.iter().all(|clip| skeleton.matches(&clip.clip.skeleton)) {
        return None;
    }
    let (track, seams) = string(clips, protected, (position, facing), rule, strung);
    for seam in seams.iter().filter(|seam| seam.distance > seam.admissible) {
        let place = places.value.get(seam.entry).map_or(&places.place, |at| &at.place);
        report.warn(place, seam_of_unlike_poses(seam, &member.track), seam_remedy(seam));
    }
    Some(track)
}

fn seam_of_unlike_poses(seam: &SeamChoice, track: &[Entry]) -> String {
    let name = |entry: usize| track.get(entry).map_or("", |entry| entry.name.as_str());
    let (before, after) = (name(seam.entry), name(seam.entry + 1));
    let SeamChoice { distance, admissible, .. } = seam;
    format!(
        "\"{before}\" and \"{after}\" meet at unlike poses (distance {distance:.2}, similar up to {admissible:.2})"
    )
}

fn seam_remedy(seam: &SeamChoice) -> String {
    if seam.held_by.is_empty() {
        return "put a clip between them, or choose other frames of either".to_owned();
    }
    let moments = seam.held_by.iter().map(|moment| format!("\"{moment}\"")).collect::<Vec<_>>().join(", ");
    format!("put a clip between them; {moments} must stay and left fewer frames to choose from")
}
