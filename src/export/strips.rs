//! Strips of poses of a scene: everybody in turn, with the boxes near them and the partners whom they meet.

use crate::clip::Clip;
use crate::constraint::Moment;
use crate::edit::{Edit, Moved};
use crate::effector::EndEffector;
use crate::export::files::OutputFile;
use crate::export::picture::{Company, StripOptions, StripThing, StripTie, StripView, strip_svg};
use crate::export::scene::object_poses;
use crate::index::{CharacterId, ObjectId, SourceFrame, floor_index};
use crate::object::{Carry, Object};
use crate::object_motion::{ObjectMotion, object_motions};
use crate::resample::{Resampled, time_of};
use crate::scene::Scene;

/// Poses of every character in `resampled` side by side, seen from the side and from above, from the first frame of their own
/// motion to the last, the moments that the scene names among them; with each pose the objects and partners near it, and
/// those partners whom something ties to the character at that time, of those who are in `resampled`. `names`: of the files
/// of all characters.
pub fn strip_files(scene: &Scene, edit: &Edit, resampled: &Resampled, names: &[String]) -> Vec<OutputFile> {
    let shown = Shown { scene, edit, resampled };
    let clips = shown.clips();
    let ties: Vec<Vec<StripTie>> = resampled.members.iter().map(|who| shown.ties(*who)).collect();
    let moved = Moved { scene, characters: &edit.characters };
    let clock = || (0..resampled.frames).map(|k| resampled.start_time + k as f64 / scene.fps);
    let thing = |(at, (object, motion)): (usize, (&Object, &ObjectMotion))| StripThing {
        size: object.size,
        poses: object_poses(&moved, motion, clock()),
        carriers: shown.carriers(ObjectId::from_usize(at)),
    };
    let motions = object_motions(scene, &moved);
    let things: Vec<StripThing> = scene.objects.iter().zip(&motions).enumerate().map(thing).collect();
    let partners: Vec<&Clip> = resampled.clips.iter().collect();
    let views = [("side", StripView::Side), ("above", StripView::Above)];
    let strips = views.into_iter().flat_map(|(word, view)| {
        let options = StripOptions { view, ..StripOptions::default() };
        let svg = |(own, clip): (usize, &Clip)| {
            let company = Company { things: &things, partners: &partners, own: Some(own), ties: &ties[own] };
            let name = &names[resampled.members[own].as_usize()];
            let svg = strip_svg(clip, &company, &options);
            OutputFile { name: format!("{name}.{word}.svg"), bytes: svg.into_bytes() }
        };
        clips.iter().enumerate().map(svg).collect::<Vec<_>>()
    });
    strips.collect()
}

/// A scene on the clock.
struct Shown<'a> {
    scene: &'a Scene,
    edit: &'a Edit,
    resampled: &'a Resampled,
}

impl Shown<'_> {
    /// Motion of the members without the time in which they wait for its beginning, moments as events.
    fn clips(&self) -> Vec<Clip> {
        let mut clips = self.resampled.clips.clone();
        for (who, clip) in self.resampled.members.iter().zip(&mut clips) {
            let begins = self.edit.characters[who.as_usize()].times[0];
            clip.usable.0 = self.frame(*who, begins).min(clip.usable.1);
        }
        for moment in self.scene.moments() {
            let Some(place) = self.place(moment.character) else { continue };
            let name = moment.name.rsplit(['/', ':']).next().unwrap_or(&moment.name);
            let clip = &mut clips[place];
            clip.events.insert(name.to_owned(), self.frame_of(moment).max(clip.usable.0));
        }
        clips
    }

    /// Position among the members.
    fn place(&self, who: CharacterId) -> Option<usize> {
        self.resampled.members.binary_search(&who).ok()
    }

    /// Output frame nearest to a scene time, within somebody's clip.
    fn frame(&self, who: CharacterId, time: f64) -> SourceFrame {
        let frame = floor_index(((time - self.resampled.start_time) * self.scene.fps).max(0.0) + 0.5);
        let last = self.resampled.clip(who).map_or(frame, |clip| clip.frame_count() - 1);
        SourceFrame::from_usize(frame.min(last))
    }

    fn frame_of(&self, moment: &Moment) -> SourceFrame {
        let who = moment.character;
        let times = &self.edit.characters[who.as_usize()].times;
        self.frame(who, time_of(times, self.scene.frame_of(moment)))
    }

    /// Whom constraints, carries and end effectors tie to a character, and when.
    fn ties(&self, who: CharacterId) -> Vec<StripTie> {
        let constraints = self.scene.constraints.iter().map(|constraint| constraint.kind.moments());
        let effectors = self.scene.end_effectors.iter().map(EndEffector::moments);
        let by_moments = constraints.chain(effectors).flat_map(|moments| self.tied(who, &moments));
        let carries = self.scene.carries.iter().flat_map(|carry| self.carried(who, carry));
        by_moments.chain(carries).collect()
    }

    /// From the first to the last of a character's own moments, those whose moments are beside them.
    fn tied(&self, who: CharacterId, moments: &[&Moment]) -> Vec<StripTie> {
        let is_own = |moment: &&&Moment| moment.character == who;
        let own = || moments.iter().filter(is_own).map(|moment| self.frame_of(moment));
        let (Some(first), Some(last)) = (own().min(), own().max()) else { return Vec::new() };
        let others = moments.iter().map(|moment| moment.character).filter(|other| *other != who);
        self.tied_to(others, (first, last))
    }

    /// Who has an object, and when.
    fn carriers(&self, object: ObjectId) -> Vec<StripTie> {
        let carries = self.scene.carries.iter().filter(|carry| carry.object == object);
        let by = |carry: &Carry| {
            let span = (self.frame_of(&carry.during.0), self.frame_of(&carry.during.1));
            self.tied_to(carry.by.iter().copied(), span)
        };
        carries.flat_map(by).collect()
    }

    /// Those who carry with a character.
    fn carried(&self, who: CharacterId, carry: &Carry) -> Vec<StripTie> {
        if !carry.by.contains(&who) {
            return Vec::new();
        }
        let span = (self.frame_of(&carry.during.0), self.frame_of(&carry.during.1));
        self.tied_to(carry.by.iter().copied().filter(|other| *other != who), span)
    }

    fn tied_to(
        &self,
        others: impl Iterator<Item = CharacterId>,
        (first, last): (SourceFrame, SourceFrame),
    ) -> Vec<StripTie> {
        let places = others.filter_map(|other| self.place(other));
        places.map(|partner| StripTie { partner, first, last }).collect()
    }
}
