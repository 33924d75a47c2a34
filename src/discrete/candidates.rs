//! Candidates: the splices that the motion graph proposes for a track, less those that would show.
//!
//! Source: Kim et al. 2009, §5.2–5.3, with the four rules of pruning made precise; what captures taught beyond it (runs
//! too short to blend, idle loops too short to hide, many candidates that give one sequence) is ours.

use std::collections::{BTreeMap, HashMap};

use crate::constraint::ChangeKind;
use crate::discrete::remap::Protected;
use crate::discrete::settings::DiscreteSettings;
use crate::graph::MotionGraph;
use crate::index::{CharacterId, FrameIndex, GraphFrame};
use crate::track::{Keep, Run, Splice, Stretch, Track};

/// A splice that could happen.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// On whose track.
    pub character: CharacterId,
    /// Of which type.
    pub kind: ChangeKind,
    /// What.
    pub splice: Splice,
    /// Where moments on copied frames stay.
    pub keep: Keep,
    /// Largest distance of the frames matched at its seams.
    pub distance: f64,
    /// Track frames i+1..j that it takes out or shows twice, or the frame it inserts after, twice.
    pub interval: (usize, usize),
}

/// A track as the graph sees it.
pub struct Seen<'a> {
    /// Whose.
    pub character: CharacterId,
    /// The track; its `clips` are all it may show.
    pub track: &'a Track,
    /// Graph clip of each of them.
    pub clips: &'a [usize],
    /// What must stay.
    pub protected: &'a Protected,
    /// Stationary track frames.
    pub still: &'a [bool],
    /// Track frames that may change.
    pub open: &'a [bool],
}

/// Candidates of one track, in a fixed order: by kind, then frames. Cost: linear in frames times transitions a frame (their
/// square for replacements).
pub fn candidates(graph: &MotionGraph, seen: &Seen<'_>, settings: &DiscreteSettings) -> Vec<Candidate> {
    let frames = Frames::new(graph, seen);
    let mut found = Vec::new();
    for i in 0..frames.nodes.len() {
        frames.between(graph, i, settings, &mut found);
        frames.insertions(graph, i, settings, &mut found);
    }
    if settings.allows(ChangeKind::Replace) {
        frames.replacements(graph, settings, &mut found);
    }
    found.retain(|candidate| seen.protected.allow(&candidate.splice, candidate.keep));
    let mut found = one_per_sequence(seen, found, settings.shortest_run);
    found.sort_by_key(|found| (found.kind, found.interval, found.keep as u8));
    without_enclosing(&mut found);
    best(found, settings.most_candidates)
}

/// Graph frame of every track frame, and where each graph frame is shown.
struct Frames<'a> {
    seen: &'a Seen<'a>,
    nodes: Vec<GraphFrame>,
    /// Run of every track frame.
    runs: Vec<usize>,
    shown: BTreeMap<GraphFrame, Vec<usize>>,
    /// Up to which frame, not included, all are stationary from each frame on, and up to which all may change.
    still_to: Vec<usize>,
    open_to: Vec<usize>,
}

impl<'a> Frames<'a> {
    fn new(graph: &MotionGraph, seen: &'a Seen<'a>) -> Self {
        let nodes: Vec<GraphFrame> = seen
            .track
            .runs
            .iter()
            .flat_map(|run| (run.first.0..=run.last.0).map(move |frame| (run.entry, FrameIndex(frame))))
            .map(|(entry, frame)| graph.frame(seen.clips[entry], frame))
            .collect();
        let mut shown: BTreeMap<GraphFrame, Vec<usize>> = BTreeMap::new();
        for (frame, node) in nodes.iter().enumerate() {
            shown.entry(*node).or_default().push(frame);
        }
        let runs = seen.track.runs.iter().enumerate();
        let runs = runs.flat_map(|(index, run)| std::iter::repeat_n(index, run.frame_count())).collect();
        Self { seen, nodes, runs, shown, still_to: ends(seen.still), open_to: ends(seen.open) }
    }

    /// Graph frames like that of track frame `i`, itself among them.
    fn alike(&self, graph: &MotionGraph, i: usize) -> Vec<(GraphFrame, f64)> {
        let own = self.nodes[i];
        let mut all = vec![(own, 0.0)];
        all.extend(graph.similar_to(own).filter(|(other, _)| *other != own));
        all
    }

    /// Deletions and duplications of what follows track frame `i` up to a frame like it.
    fn between(
        &self,
        graph: &MotionGraph,
        i: usize,
        settings: &DiscreteSettings,
        found: &mut Vec<Candidate>,
    ) {
        for (node, distance) in self.alike(graph, i) {
            let later = self.shown.get(&node).into_iter().flatten().copied().filter(|j| *j > i);
            for j in later.filter(|j| self.allowed(i, *j, settings)) {
                let mut add = |kind, splice: Splice, keep| {
                    found.push(self.candidate(kind, (splice, keep), distance, (i + 1, j)));
                };
                if settings.allows(ChangeKind::Delete) && j + 1 < self.nodes.len() {
                    add(ChangeKind::Delete, Splice::delete(i, j), Keep::First);
                }
                if settings.allows(ChangeKind::Duplicate) {
                    let splice = Splice::duplicate(i, j);
                    if self.seen.protected.tell_copies_apart(&splice) {
                        add(ChangeKind::Duplicate, splice.clone(), Keep::Second);
                    }
                    add(ChangeKind::Duplicate, splice, Keep::First);
                }
            }
        }
    }

    /// Insertions after track frame `i` of what lies in some clip between two frames like it.
    fn insertions(
        &self,
        graph: &MotionGraph,
        i: usize,
        settings: &DiscreteSettings,
        found: &mut Vec<Candidate>,
    ) {
        if !settings.allows(ChangeKind::Insert) || i + 1 >= self.nodes.len() || !self.seen.open[i] {
            return;
        }
        let alike = self.alike(graph, i);
        for (from, before) in &alike {
            for (to, after) in &alike {
                let Some(stretch) = self.stretch(graph, (*from, *to), settings, |_| true) else { continue };
                let splice = Splice::insert(i, vec![stretch]);
                found.push(self.candidate(
                    ChangeKind::Insert,
                    (splice, Keep::First),
                    before.max(*after),
                    (i, i),
                ));
            }
        }
    }

    /// Replacements of what lies between two track frames by what lies in some clip between two frames like them.
    fn replacements(&self, graph: &MotionGraph, settings: &DiscreteSettings, found: &mut Vec<Candidate>) {
        let alike: Vec<_> = (0..self.nodes.len()).map(|i| self.alike(graph, i)).collect();
        let (mut known, ends) = (false, self.seen.protected.ends_up_to(self.nodes.len()));
        for i in 0..self.nodes.len() {
            let last = (i + settings.longest).min(self.nodes.len().saturating_sub(2));
            for j in i + settings.shortest..=last {
                // Between frames like none but themselves there is only what lies there.
                let only_same = alike[i].len() == 1 && alike[j].len() == 1 && self.runs[i] == self.runs[j];
                if only_same && known || ends[i] < ends[j] || !self.allowed(i, j, settings) {
                    continue;
                }
                let least = self.least_exchange((i, j), settings);
                for (from, before) in &alike[i] {
                    for (to, after) in &alike[j] {
                        // One of those that change nothing stands for all; it changes no number of frames.
                        let same =
                            (*from, *to) == (self.nodes[i], self.nodes[j]) && self.runs[i] == self.runs[j];
                        if same && (known || least > 0) {
                            continue;
                        }
                        let worth = |count: usize| count.abs_diff(j - i) >= least;
                        let stretch = self.stretch(graph, (*from, *to), settings, worth);
                        let Some(stretch) = stretch else { continue };
                        let splice = (Splice::replace(i, j, vec![stretch]), Keep::First);
                        known |= same && self.seen.protected.allow(&splice.0, splice.1);
                        found.push(self.candidate(
                            ChangeKind::Replace,
                            splice,
                            before.max(*after),
                            (i + 1, j),
                        ));
                    }
                }
            }
        }
    }

    fn candidate(
        &self,
        kind: ChangeKind,
        (splice, keep): (Splice, Keep),
        distance: f64,
        interval: (usize, usize),
    ) -> Candidate {
        Candidate { character: self.seen.character, kind, splice, keep, distance, interval }
    }

    /// Whether somebody stands from track frame i to j.
    fn idle(&self, i: usize, j: usize) -> bool {
        self.still_to[i] > j
    }

    /// Whether track frames i+1 to j may come or go: neither too few nor too many, and where all of them are still, enough
    /// that nobody sees them again.
    fn allowed(&self, i: usize, j: usize, settings: &DiscreteSettings) -> bool {
        settings.lengths(self.idle(i, j)).contains(&(j - i)) && self.open_to[i] > j
    }

    /// How many more or fewer frames in the place of track frames i+1 to j are more than swapping strides: so many that steps
    /// come or go. Strides differ by centimetres, and a swap for the sake of these would win nearly every update.
    fn least_exchange(&self, (i, j): (usize, usize), settings: &DiscreteSettings) -> usize {
        settings.least_exchange(self.idle(i, j))
    }

    /// Frames after `from` up to `to` of one clip that the track may show, if they are as many as allowed, and as `wanted`.
    fn stretch(
        &self,
        graph: &MotionGraph,
        (from, to): (GraphFrame, GraphFrame),
        settings: &DiscreteSettings,
        wanted: impl Fn(usize) -> bool,
    ) -> Option<Stretch> {
        let ((clip, first), (other, last)) = (graph.place(from), graph.place(to));
        if clip != other || first >= last {
            return None;
        }
        let count = last.as_usize() - first.as_usize();
        if count > settings.longest || !wanted(count) {
            return None;
        }
        // The last entry of a clip is the one that only insertions use.
        let entry = self.seen.clips.iter().rposition(|known| *known == clip)?;
        let still = &self.seen.track.clips[entry].stationary[first.as_usize()..=last.as_usize()];
        let idle = still.iter().all(|still| *still);
        settings.lengths(idle).contains(&count).then(|| Stretch {
            entry,
            first: FrameIndex(first.0 + 1),
            last,
        })
    }
}

/// For each place, where the values that are true from there on end.
fn ends(values: &[bool]) -> Vec<usize> {
    let mut ends: Vec<usize> = (0..values.len()).collect();
    for place in (0..values.len()).rev().filter(|place| values[*place]) {
        ends[place] = ends.get(place + 1).copied().unwrap_or(place + 1);
    }
    ends
}

/// How many runs are too short to blend: between two seams there are two blends.
fn too_short(counts: impl ExactSizeIterator<Item = usize>, shortest: usize) -> usize {
    let last = counts.len() - 1;
    let least = |index: usize| if index == 0 || index == last { shortest } else { 2 * shortest };
    counts.enumerate().filter(|(index, count)| *count < least(*index)).count()
}

/// Of candidates that give the same sequence of frames with the same moments, the one with the nearest frames. None that
/// leaves more runs too short to blend than there were before.
fn one_per_sequence(seen: &Seen<'_>, found: Vec<Candidate>, shortest: usize) -> Vec<Candidate> {
    let before = too_short(seen.track.runs.iter().map(Run::frame_count), shortest);
    let mut kept: HashMap<Vec<u64>, Candidate> = HashMap::new();
    let (mut shown, mut key) = (Vec::new(), Vec::new());
    for candidate in found {
        seen.track.show_after(&candidate.splice, &mut shown);
        if too_short(shown.iter().map(Stretch::frame_count), shortest) > before {
            continue;
        }
        tell_outcome(seen, (&candidate, &shown), &mut key);
        match kept.get_mut(&key) {
            Some(known) if (known.distance, known.kind) <= (candidate.distance, candidate.kind) => {}
            Some(known) => *known = candidate,
            None => drop(kept.insert(key.clone(), candidate)),
        }
    }
    let mut kept: Vec<(Vec<u64>, Candidate)> = kept.into_iter().collect();
    kept.sort_unstable_by(|a, b| a.0.cmp(&b.0));
    kept.into_iter().map(|(_, candidate)| candidate).collect()
}

/// What a candidate leads to: the sequence of frames, and where moments are.
pub fn outcome(seen: &Seen<'_>, candidate: &Candidate) -> Vec<u64> {
    let (mut key, shown) = (Vec::new(), seen.track.shown_after(&candidate.splice));
    tell_outcome(seen, (candidate, &shown), &mut key);
    key
}

/// The same in place of what `key` holds.
fn tell_outcome(seen: &Seen<'_>, (candidate, shown): (&Candidate, &[Stretch]), key: &mut Vec<u64>) {
    tell_sequence(seen, shown, key);
    key.extend(moments_after(seen, candidate).map(|place| place as u64));
}

/// How many moments stay, and from which one on all move by as many frames as come or go: with the sequence, this says where
/// each is. Where as many come as go, those taken out part the others.
fn moments_after(seen: &Seen<'_>, Candidate { splice, keep, .. }: &Candidate) -> [usize; 2] {
    let (moments, count) = (&seen.protected.moments, seen.track.frame_count());
    let (last_before, first_after) = splice.torn(*keep);
    let stay = moments.partition_point(|frame| *frame <= last_before as f64);
    let follow = stay + moments[stay..].partition_point(|frame| *frame < first_after as f64);
    let nobody_moves = stay == follow && splice.new_count(count) == count;
    if nobody_moves { [moments.len(); 2] } else { [stay, follow] }
}

/// Clip, first and last frame of each stretch of frames that follow each other, in place of what `key` holds.
fn tell_sequence(seen: &Seen<'_>, shown: &[Stretch], key: &mut Vec<u64>) {
    key.clear();
    for run in shown {
        let [clip, first, last] =
            [seen.clips[run.entry] as u64, u64::from(run.first.0), u64::from(run.last.0)];
        match key.last_chunk_mut() {
            Some([before, _, end]) if *before == clip && *end + 1 == first => *end = last,
            _ => key.extend([clip, first, last]),
        }
    }
}

/// Drops whatever encloses a candidate of its own type: the smaller change comes first. Of one interval the nearest stays.
/// `found`: by kind and interval. Cost: `O(n log n)`.
fn without_enclosing(found: &mut Vec<Candidate>) {
    let mut keep = vec![true; found.len()];
    let mut order: Vec<usize> = (0..found.len()).filter(|c| found[*c].kind != ChangeKind::Insert).collect();
    // From the latest start on, the nearest end seen so far belongs to something inside.
    order.sort_by(|a, b| {
        let (a, b) = (&found[*a], &found[*b]);
        let places = (a.kind, b.interval.0, a.interval.1).cmp(&(b.kind, a.interval.0, b.interval.1));
        places.then(a.distance.total_cmp(&b.distance))
    });
    let mut inside: Option<(ChangeKind, (usize, usize))> = None;
    for place in order {
        let Candidate { kind, interval, .. } = found[place];
        match inside {
            Some((known, within)) if known == kind && within.1 <= interval.1 => {
                keep[place] = within == interval && kind != ChangeKind::Replace;
            }
            _ => inside = Some((kind, interval)),
        }
    }
    drop_enclosing_insertions(found, &mut keep);
    let mut place = 0;
    found.retain(|_| {
        place += 1;
        keep[place - 1]
    });
}

/// Seams of insertions nearer than this are one place, frames.
const SAME_PLACE: usize = 5;

fn drop_enclosing_insertions(found: &[Candidate], keep: &mut [bool]) {
    let inserted = |candidate: &Candidate| candidate.splice.inserted[0];
    let places: Vec<usize> = (0..found.len()).filter(|c| found[*c].kind == ChangeKind::Insert).collect();
    for (at, place) in places.iter().enumerate() {
        let own = inserted(&found[*place]);
        let near =
            |other: &&usize| found[**other].splice.after.abs_diff(found[*place].splice.after) <= SAME_PLACE;
        let before = places[..at].iter().rev().take_while(near);
        let after = places[at + 1..].iter().take_while(near);
        let encloses = |other: &usize| {
            let within = inserted(&found[*other]);
            within.entry == own.entry && own.first <= within.first && within.last <= own.last && within != own
        };
        keep[*place] = !before.chain(after).any(encloses);
    }
}

/// At most `most` candidates, the nearest first, but four of each type; in the order they came.
fn best(found: Vec<Candidate>, most: usize) -> Vec<Candidate> {
    const LEAST_OF_A_KIND: usize = 4;
    if found.len() <= most {
        return found;
    }
    let mut order: Vec<usize> = (0..found.len()).collect();
    order.sort_by(|a, b| found[*a].distance.total_cmp(&found[*b].distance).then(a.cmp(b)));
    let mut of_kind = [0; ChangeKind::ALL.len()];
    let first: Vec<usize> = order
        .iter()
        .copied()
        .filter(|place| {
            let count = &mut of_kind[found[*place].kind as usize];
            *count += 1;
            *count <= LEAST_OF_A_KIND
        })
        .collect();
    let rest = order.iter().copied().filter(|place| !first.contains(place));
    let mut chosen: Vec<usize> = first.iter().copied().chain(rest).take(most).collect();
    chosen.sort_unstable();
    let mut found: Vec<Option<Candidate>> = found.into_iter().map(Some).collect();
    chosen.into_iter().filter_map(|place| found[place].take()).collect()
}
