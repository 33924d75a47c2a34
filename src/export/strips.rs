//! Strips of poses of a scene: everybody in turn, with the boxes near them and the partners whom they meet.

use crate::clip::Clip;
use crate::constraint::Moment;
use crate::edit::{Edit, Moved};
use crate::effector::EndEffector;
use crate::export::files::{OutputFile, file_names};
use crate::export::picture::{Company, StripOptions, StripThing, StripTie, StripView, strip_svg};
use crate::export::scene::object_poses;
use crate::index::{SourceFrame, floor_index};
use crate::object::{Carry, Object};
use crate::object_motion::{ObjectMotion, object_motions};
use crate::resample::{Resampled, time_of};
use crate::scene::Scene;

/// Poses of every character side by side, seen from the side and from above, from the first frame of their own motion to the
/// last, the moments that the scene names among them; with each pose the objects and partners near it, and those partners
/// whom something ties to the character at that time.
pub fn strip_files(scene: &Scene, edit: &Edit, resampled: &Resampled) -> Vec<OutputFile> {
    let names: Vec<&str> = scene.characters.iter().map(|character| character.name.as_str()).collect();
    let shown = Shown { scene, edit, resampled };
    let clips = shown.clips();
    let ties: Vec<Vec<StripTie>> = (0..clips.len()).map(|who| shown.ties(who)).collect();
    let moved = Moved { scene, characters: &edit.characters };
    let frames = clips.iter().map(Clip::frame_count).max().unwrap_or(1);
    let clock = || (0..frames).map(|k| resampled.start_time + k as f64 / scene.fps);
    let thing = |(object, motion): (&Object, &ObjectMotion)| StripThing {
        size: object.size,
        poses: object_poses(&moved, motion, clock()),
    };
    let motions = object_motions(scene, &moved);
    let things: Vec<StripThing> = scene.objects.iter().zip(&motions).map(thing).collect();
    let partners: Vec<&Clip> = resampled.clips.iter().collect();
    let views = [("side", StripView::Side), ("above", StripView::Above)];
    let strips = views.into_iter().flat_map(|(word, view)| {
        let options = StripOptions { view, ..StripOptions::default() };
        let svg = |(who, clip): (usize, &Clip)| {
            let company = Company { things: &things, partners: &partners, own: Some(who), ties: &ties[who] };
            strip_svg(clip, &company, &options)
        };
        file_names(&names).into_iter().zip(clips.iter().enumerate().map(svg).collect::<Vec<_>>()).map(
            move |(name, svg)| OutputFile { name: format!("{name}.{word}.svg"), bytes: svg.into_bytes() },
        )
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
    /// Everybody's motion without the time in which they wait for its beginning, moments as events.
    fn clips(&self) -> Vec<Clip> {
        let mut clips = self.resampled.clips.clone();
        for (who, clip) in clips.iter_mut().enumerate() {
            clip.usable.0 = self.frame(who, self.edit.characters[who].times[0]).min(clip.usable.1);
        }
        for moment in self.scene.moments() {
            let name = moment.name.rsplit(['/', ':']).next().unwrap_or(&moment.name);
            let clip = &mut clips[moment.character.as_usize()];
            clip.events.insert(name.to_owned(), self.frame_of(moment).max(clip.usable.0));
        }
        clips
    }

    /// Output frame nearest to a scene time, within somebody's clip.
    fn frame(&self, who: usize, time: f64) -> SourceFrame {
        let frame = floor_index(((time - self.resampled.start_time) * self.scene.fps).max(0.0) + 0.5);
        SourceFrame::from_usize(frame.min(self.resampled.clips[who].frame_count() - 1))
    }

    fn frame_of(&self, moment: &Moment) -> SourceFrame {
        let who = moment.character.as_usize();
        self.frame(who, time_of(&self.edit.characters[who].times, self.scene.frame_of(moment)))
    }

    /// Whom constraints, carries and end effectors tie to a character, and when.
    fn ties(&self, who: usize) -> Vec<StripTie> {
        let constraints = self.scene.constraints.iter().map(|constraint| constraint.kind.moments());
        let effectors = self.scene.end_effectors.iter().map(EndEffector::moments);
        let by_moments = constraints.chain(effectors).flat_map(|moments| self.tied(who, &moments));
        let carries = self.scene.carries.iter().flat_map(|carry| self.carried(who, carry));
        by_moments.chain(carries).collect()
    }

    /// From the first to the last of a character's own moments, those whose moments are beside them.
    fn tied(&self, who: usize, moments: &[&Moment]) -> Vec<StripTie> {
        let is_own = |moment: &&&Moment| moment.character.as_usize() == who;
        let own = || moments.iter().filter(is_own).map(|moment| self.frame_of(moment));
        let (Some(first), Some(last)) = (own().min(), own().max()) else { return Vec::new() };
        let others = moments.iter().map(|moment| moment.character.as_usize()).filter(|other| *other != who);
        others.map(|partner| StripTie { partner, first, last }).collect()
    }

    /// Those who carry with a character.
    fn carried(&self, who: usize, carry: &Carry) -> Vec<StripTie> {
        if !carry.by.iter().any(|by| by.as_usize() == who) {
            return Vec::new();
        }
        let (first, last) = (self.frame_of(&carry.during.0), self.frame_of(&carry.during.1));
        let others = carry.by.iter().map(|by| by.as_usize()).filter(|other| *other != who);
        others.map(|partner| StripTie { partner, first, last }).collect()
    }
}
