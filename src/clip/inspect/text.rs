//! Facts of a clip as one screen of text.

use std::fmt::Write as _;

use super::{ClipFacts, FrameRange};

/// Longest line, characters.
const WIDTH: usize = 100;
/// Most lines of a clip.
const HEIGHT: usize = 30;
/// Characters before the value of a line.
const MARGIN: usize = 14;
/// Ranges that are listed before it is said how many more there are.
const RANGES_SHOWN: usize = 10;

/// Limbs and trunk: heading, what the names of roles begin with there, which roles.
const BODY: [(&str, &str, &[&str]); 5] = [
    ("trunk", "", &["pelvis", "spine", "chest", "neck", "head"]),
    ("left arm", "left_", &["clavicle", "shoulder", "elbow", "hand"]),
    ("right arm", "right_", &["clavicle", "shoulder", "elbow", "hand"]),
    ("left leg", "left_", &["hip", "knee", "foot", "toe"]),
    ("right leg", "right_", &["hip", "knee", "foot", "toe"]),
];

/// The facts as a screen of text: at most 30 lines of 100 characters, all ended. What does not fit is counted; it is all in
/// the facts.
pub fn facts_text(facts: &ClipFacts) -> String {
    let entries: Vec<Entry> = measures(facts).into_iter().chain(phases(facts)).chain(joints(facts)).collect();
    let laid_out = |most_lines: usize| {
        let mut lines = vec![clipped(&facts.file, WIDTH)];
        for (key, value, most) in &entries {
            put(&mut lines, key, value, (*most).min(most_lines));
        }
        lines
    };
    let mut lines = laid_out(usize::MAX);
    if lines.len() >= HEIGHT {
        // Some twenty entries: with a line each, and one for warnings, they fit.
        lines = laid_out(1);
    }
    put_warnings(&mut lines, &facts.warnings);
    let mut text = String::new();
    for line in lines {
        writeln!(text, "{line}").expect("writing to a string does not fail");
    }
    text
}

/// Key, value and the most lines it may take.
type Entry = (&'static str, String, usize);

/// What is measured of the whole clip.
fn measures(facts: &ClipFacts) -> Vec<Entry> {
    let FrameRange { from, to } = facts.usable;
    let speed = facts.root_path / facts.seconds.max(1.0 / facts.fps);
    vec![
        (
            "skeleton",
            format!(
                "{} joints, {:.2} m from the lowest to the highest, standing",
                facts.joints, facts.height
            ),
            1,
        ),
        (
            "frames",
            format!(
                "{} at {} a second; {from}–{to} usable, {:.2} s",
                facts.frames,
                rounded(facts.fps),
                facts.seconds
            ),
            1,
        ),
        ("units", format!("{} m a file unit, {} up", rounded(facts.unit_to_m), facts.up), 1),
        (
            "path",
            format!(
                "{:.2} m on the ground, {speed:.2} m/s; {:.2} m from start to end; {}",
                facts.root_path,
                facts.displacement,
                turn(facts.turn_deg)
            ),
            1,
        ),
    ]
}

/// When what happens: feet on the ground, flights, rests, events.
fn phases(facts: &ClipFacts) -> Vec<Entry> {
    let span = f64::from(facts.usable.to - facts.usable.from).max(1.0);
    let mut entries = Vec::new();
    for (key, foot) in ["left foot", "right foot"].into_iter().zip(&facts.feet) {
        let frames: u32 = foot.ranges.iter().map(|range| range.to - range.from).sum();
        let share = 100.0 * f64::from(frames) / span;
        let on = if foot.ranges.is_empty() { String::new() } else { format!("on the ground {share:.0} %: ") };
        entries.push((key, on + &range_list(&foot.ranges), 2));
    }
    for (key, side) in [("left hand", "left"), ("right hand", "right")] {
        let ranges = stated(facts, side);
        if !ranges.is_empty() {
            entries.push((key, format!("bears, as stated: {}", range_list(&ranges)), 2));
        }
    }
    let higher = higher_ground(facts);
    if !higher.is_empty() {
        entries.push(("higher", higher, 2));
    }
    if let Some(slide) = facts.foot_slide {
        entries.push(("foot slide", format!("{slide:.3} m/s while on the ground"), 1));
    }
    let flights: Vec<FrameRange> =
        facts.flights.iter().map(|flight| FrameRange { from: flight.from, to: flight.to }).collect();
    entries.push(("flights", range_list(&flights), 2));
    entries.push(("stationary", range_list(&facts.stationary), 2));
    if let Some(transitions) = &facts.transitions {
        entries.push(("transitions", transitions.text(), 1));
    }
    if !facts.events.is_empty() {
        let events: Vec<String> =
            facts.events.iter().map(|event| format!("{} {}", event.name, event.frame)).collect();
        entries.push(("events", events.join(", "), 2));
    }
    entries
}

/// Contacts of the hand of a side: of its joint, or of the end of the forearm.
fn stated(facts: &ClipFacts, side: &str) -> Vec<FrameRange> {
    let joint_of = |part: &str| facts.roles.iter().find(|fact| fact.role == format!("{side}_{part}"));
    let hand = joint_of("hand").map(|fact| fact.joint.clone());
    let hand = hand.or_else(|| Some(format!("{} end", joint_of("elbow")?.joint)));
    let of_hand = facts.contacts.iter().filter(|range| hand.is_some() && range.joint == hand);
    of_hand.map(|range| FrameRange { from: range.from, to: range.to }).collect()
}

/// Heights of ground that is not the floor, with the first frame on each; heel and toe of one foot, and feet side by side, count
/// once.
fn higher_ground(facts: &ClipFacts) -> String {
    /// Grounds nearer than this in height are one, metres.
    const SAME: f64 = 0.08;
    let raised = facts.contacts.iter().filter_map(|range| Some((range.from, range.to, range.ground?)));
    let mut raised: Vec<(u32, u32, f64)> = raised.collect();
    raised.sort_by_key(|(from, ..)| *from);
    let mut kept: Vec<(u32, u32, f64)> = Vec::new();
    for (from, to, height) in raised {
        match kept.last_mut() {
            Some(last) if from <= last.1 && (height - last.2).abs() < SAME => last.1 = last.1.max(to),
            _ => kept.push((from, to, height)),
        }
    }
    let more = kept.len().saturating_sub(RANGES_SHOWN);
    let shown: Vec<String> = kept
        .iter()
        .take(RANGES_SHOWN)
        .map(|(from, to, height)| format!("{height:.2} m {from}–{to}"))
        .collect();
    let tail = if more > 0 { format!(" and {more} more") } else { String::new() };
    shown.join(", ") + &tail
}

/// A change of facing in words, to whole degrees.
fn turn(degrees: f64) -> String {
    match degrees.round() {
        0.0 => "faces as at the start".to_owned(),
        left if left > 0.0 => format!("turns {left}° left"),
        right => format!("turns {}° right", -right),
    }
}

/// Every role with its joint, by limbs; the roles without one; how many joints have none.
fn joints(facts: &ClipFacts) -> Vec<Entry> {
    let joint_of =
        |role: &str| facts.roles.iter().find(|fact| fact.role == role).map(|fact| fact.joint.as_str());
    let mut entries = Vec::new();
    for (limb, side, roles) in BODY {
        let found: Vec<String> = roles
            .iter()
            .filter_map(|role| Some(format!("{role} {}", joint_of(&format!("{side}{role}"))?)))
            .collect();
        if !found.is_empty() {
            entries.push((limb, found.join(", "), 2));
        }
    }
    let mut rest = Vec::new();
    if !facts.missing_roles.is_empty() {
        rest.push(format!("no joint for {}", facts.missing_roles.join(", ")));
    }
    match facts.joints - facts.roles.len() {
        0 => {}
        1 => rest.push("1 joint without a role".to_owned()),
        count => rest.push(format!("{count} joints without a role")),
    }
    if !rest.is_empty() {
        entries.push(("other", rest.join("; "), 2));
    }
    entries
}

/// Warnings as far as the screen reaches; the last line counts the rest.
fn put_warnings(lines: &mut Vec<String>, warnings: &[String]) {
    for (index, warning) in warnings.iter().enumerate() {
        let room = HEIGHT - lines.len();
        let rest = warnings.len() - index;
        if room == 1 && rest > 1 {
            put(lines, "warning", &format!("{rest} more; --json has them all"), 1);
            return;
        }
        let most = if rest > 1 { room - 1 } else { room };
        put(lines, "warning", warning, most.min(3));
    }
}

/// Adds an entry, wrapped, its end left out where it has more than `most` lines.
fn put(lines: &mut Vec<String>, key: &str, value: &str, most: usize) {
    let mut wrapped = wrapped(value, WIDTH - MARGIN);
    if wrapped.len() > most {
        wrapped.truncate(most);
        if let Some(last) = wrapped.last_mut() {
            *last = clipped(&format!("{last} …"), WIDTH - MARGIN);
        }
    }
    for (index, line) in wrapped.iter().enumerate() {
        let key = if index == 0 { key } else { "" };
        lines.push(format!("  {key:<12}{line}"));
    }
}

/// Lines of at most `width` characters, broken between words; one line at least.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let word = clipped(word, width);
        let last = lines.len() - 1;
        let used = lines[last].chars().count();
        if used == 0 {
            lines[last] = word;
        } else if used + 1 + word.chars().count() <= width {
            lines[last] += " ";
            lines[last] += &word;
        } else {
            lines.push(word);
        }
    }
    lines
}

/// The text, its end replaced by an ellipsis where it is longer than `width` characters; control characters as boxes.
fn clipped(text: &str, width: usize) -> String {
    let clean = text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c });
    if text.chars().count() <= width {
        return clean.collect();
    }
    clean.take(width - 1).chain(['…']).collect()
}

/// A number with at most seven decimals.
fn rounded(value: f64) -> String {
    let text = format!("{value:.7}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn range_list(ranges: &[FrameRange]) -> String {
    if ranges.is_empty() {
        return "none".to_owned();
    }
    let shown: Vec<String> =
        ranges.iter().take(RANGES_SHOWN).map(|range| format!("{}–{}", range.from, range.to)).collect();
    let more = ranges.len().saturating_sub(RANGES_SHOWN);
    let tail = if more > 0 { format!(" and {more} more") } else { String::new() };
    shown.join(", ") + &tail
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::clip::builtin::generate;
    use crate::clip::inspect::{EventFact, JointRange, RoleFact, TransitionFacts, inspect};
    use crate::clip::read::{ReadClip, Up};

    fn facts() -> ClipFacts {
        let clip = generate("walk", &BTreeMap::new()).expect("a generated clip");
        let read = ReadClip { header_fps: clip.fps, clip, unit_to_m: 1.0, up: Up::Y, notes: Vec::new() };
        inspect("builtin:walk", &read)
    }

    fn fits(text: &str) -> bool {
        text.lines().count() <= HEIGHT && text.lines().all(|line| line.chars().count() <= WIDTH)
    }

    #[test]
    fn a_clip_is_one_screen_however_much_there_is_to_tell() {
        let mut facts = facts();
        assert!(fits(&facts_text(&facts)));
        facts.file = "x/".repeat(200);
        facts.warnings = (0..50).map(|index| format!("{index} {}", "word ".repeat(90))).collect();
        let (pairs, whole_cycles) = (1_000_000, Some(0.5));
        let transitions = TransitionFacts { pairs, idle: pairs, whole_cycles, ..TransitionFacts::default() };
        facts.transitions = Some(transitions);
        facts.events = (0..50).map(|frame| EventFact { name: "event".repeat(5), frame }).collect();
        let contacts = &facts.contacts;
        facts.flights = (0..3000).map(|index| contacts[index % contacts.len()].clone()).collect();
        for role in &mut facts.roles {
            role.joint = format!("{} ", role.role).repeat(30);
        }
        // Hands and feet that bear again and again, each time higher, and rests in between.
        let ranges: Vec<FrameRange> =
            (10_000..10_100).map(|at| FrameRange { from: 9 * at, to: 9 * at + 4 }).collect();
        let hands = facts.roles.iter().filter(|role| role.role.ends_with("_hand"));
        let of_hand = |joint: &String, at: &FrameRange| JointRange {
            joint: Some(joint.clone()),
            from: at.from,
            to: at.to,
            ground: Some(f64::from(at.from)),
        };
        facts.contacts = hands.flat_map(|hand| ranges.iter().map(|at| of_hand(&hand.joint, at))).collect();
        facts.feet.iter_mut().for_each(|foot| foot.ranges.clone_from(&ranges));
        facts.stationary = ranges;
        assert!(fits(&facts_text(&facts)), "{}", facts_text(&facts));
        assert!(facts_text(&facts).contains("more; --json has them all"));
    }

    #[test]
    fn every_role_is_told_found_or_not() {
        let mut facts = facts();
        let lost: RoleFact = facts.roles.remove(3);
        facts.missing_roles.push(lost.role.clone());
        let text = facts_text(&facts);
        for role in &facts.roles {
            assert!(text.contains(&role.joint), "{}", role.joint);
        }
        assert!(text.contains(&format!("no joint for {}; 1 joint without a role", lost.role)), "{text}");
    }

    #[test]
    fn a_name_cannot_break_a_line() {
        let mut facts = facts();
        facts.roles[0].joint = "a\nb\u{1b}[2J".to_owned();
        facts.file = "a\nb".to_owned();
        let text = facts_text(&facts);
        assert!(!text.contains('\u{1b}') && text.starts_with("a\u{fffd}b\n"), "{text}");
    }
}
