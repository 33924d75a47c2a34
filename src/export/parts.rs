//! Results of many characters in parts: each is sampled, corrected and written before the next, so that memory holds one.

use std::collections::BTreeMap;

use crate::embody::closed_groups;
use crate::geometry::c64;
use crate::index::{CharacterId, ObjectId, floor_index};
use crate::scene::Scene;
use crate::ties::Ties;

/// Scenes of more characters are written in parts, and their BVH files only on request.
pub const MANY: usize = 200;
/// Characters of a part; more where those reach others.
pub const OF_A_PART: usize = 100;

/// Characters and objects that are written together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Rising; all that any of them reaches is among them.
    pub members: Vec<CharacterId>,
    /// Those that one of the members is the first to carry; in the first part also all that nobody carries.
    pub objects: Vec<ObjectId>,
    /// Name of its GLB file.
    pub glb: String,
}

impl Part {
    /// A whole scene as one part.
    pub fn everything(scene: &Scene) -> Self {
        Self {
            members: (0..scene.characters.len()).map(CharacterId::from_usize).collect(),
            objects: (0..scene.objects.len()).map(ObjectId::from_usize).collect(),
            glb: "scene.glb".to_owned(),
        }
    }
}

/// The parts of a scene: one of up to [`MANY`] characters; else of a hundred each or a little more, those who reach each other
/// together, and neighbours as far as that goes. `places`: where everybody is, on the plan. Cost: linear but for one sort.
pub fn parts(scene: &Scene, ties: &Ties, places: &[c64]) -> Vec<Part> {
    if scene.characters.len() <= MANY {
        return vec![Part::everything(scene)];
    }
    let along = along_curve(places);
    let mut groups = closed_groups(scene, ties);
    groups.sort_by_key(|group| along[group[0].as_usize()]);
    let mut members: Vec<Vec<CharacterId>> = vec![Vec::new()];
    for mut group in groups {
        if members.last().is_some_and(|last| last.len() >= OF_A_PART) {
            members.push(Vec::new());
        }
        members.last_mut().expect("there is a first part").append(&mut group);
    }
    let digits = members.len().to_string().len();
    let named = members.into_iter().enumerate().map(|(index, mut members)| {
        members.sort_unstable();
        Part { members, objects: Vec::new(), glb: format!("scene-{:0digits$}.glb", index + 1) }
    });
    let mut parts: Vec<Part> = named.collect();
    let part_of: BTreeMap<CharacterId, usize> = parts
        .iter()
        .enumerate()
        .flat_map(|(index, part)| part.members.iter().map(move |who| (*who, index)))
        .collect();
    let mut carriers: BTreeMap<ObjectId, CharacterId> = BTreeMap::new();
    for carry in &scene.carries {
        carry.by.first().inspect(|who| {
            carriers.entry(carry.object).or_insert(**who);
        });
    }
    for object in (0..scene.objects.len()).map(ObjectId::from_usize) {
        let part = carriers.get(&object).map_or(0, |who| part_of[who]);
        parts[part].objects.push(object);
    }
    parts
}

/// Cells of the plan along each side of its square, as a power of two: those of a square kilometre are 15 mm wide.
const CELLS: u32 = 16;

/// How far along a Hilbert curve over the plan each place is: who is near on the curve is near on the plan.
///
/// Source: Hilbert, *Ueber die stetige Abbildung einer Linie auf ein Flächenstück*, Mathematische Annalen 38, 1891.
fn along_curve(places: &[c64]) -> Vec<u64> {
    let least = |of: fn(&c64) -> f64| places.iter().map(of).fold(f64::INFINITY, f64::min);
    let most = |of: fn(&c64) -> f64| places.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
    let (left, bottom) = (least(|place| place.re), least(|place| place.im));
    let side = (most(|place| place.re) - left).max(most(|place| place.im) - bottom).max(f64::MIN_POSITIVE);
    let last = (1_u64 << CELLS) - 1;
    let cell = |metres: f64| (floor_index(metres / side * last as f64) as u64).min(last);
    places.iter().map(|place| hilbert(cell(place.re - left), cell(place.im - bottom))).collect()
}

/// Position of a cell on the curve.
fn hilbert(mut x: u64, mut y: u64) -> u64 {
    let last = (1_u64 << CELLS) - 1;
    let mut along = 0;
    for bit in (0..CELLS).rev() {
        let (right, up) = ((x >> bit) & 1, (y >> bit) & 1);
        along = 4 * along + ((3 * right) ^ up);
        // The lower quarters are turned, one of them the other way.
        if up == 0 {
            if right == 1 {
                (x, y) = (last - x, last - y);
            }
            (x, y) = (y, x);
        }
    }
    along
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_follows_on_the_curve_is_the_neighbour_on_the_plan() {
        // The corners of 32 by 32 equal cells.
        let step = 1 << (CELLS - 5);
        let mut cells: Vec<(u64, u64)> = (0..32).flat_map(|x| (0..32).map(move |y| (x, y))).collect();
        cells.sort_by_key(|(x, y)| hilbert(x * step, y * step));
        for pair in cells.windows(2) {
            assert_eq!(pair[0].0.abs_diff(pair[1].0) + pair[0].1.abs_diff(pair[1].1), 1, "{pair:?}");
        }
    }

    #[test]
    fn people_at_one_place_and_far_places_are_no_trouble() {
        let here = c64::new(3.0, -1.0);
        assert_eq!(along_curve(&[here, here]), [0, 0]);
        assert_eq!(along_curve(&[c64::new(-1e5, 0.0), c64::new(1e5, 0.0)])[0], 0);
        assert!(along_curve(&[]).is_empty());
    }
}
