//! Six point masses that move by formulas: poses, masses and forces known to nine digits.

use cotillion::physics::GRAVITY;
use cotillion::physics::derivatives::Lanes;
use cotillion::physics::zmp::LinkForces;
use glam::DVec3;

pub(crate) const LINKS: usize = 6;

pub(crate) fn masses() -> [f64; LINKS] {
    std::array::from_fn(|i| 2.0 + i as f64)
}

/// Place and acceleration of link `i` in pose `k`, metres and m/s².
pub(crate) fn link(i: usize, k: usize) -> (DVec3, DVec3) {
    let (i, k) = (i as f64, k as f64);
    let place =
        DVec3::new(0.3 * (1.0 + i + 0.9 * k).sin(), 0.4 + 0.25 * i, 0.2 * (2.0 + 0.7 * i + 1.3 * k).cos());
    let acceleration = DVec3::new(
        0.8 * (2.0 * i + 0.5 + k).sin(),
        0.6 * (1.5 * i + 0.4 * k).cos(),
        -0.5 * (i + 0.3 - k).sin(),
    );
    (place, acceleration)
}

/// Forces on point masses in one frame. `links`: mass, place, acceleration.
pub(crate) fn forces_of(links: &[(f64, DVec3, DVec3)]) -> LinkForces {
    let mut places = Lanes::zeros(3 * links.len(), 1);
    let mut forces = places.clone();
    for (index, (mass, place, acceleration)) in links.iter().enumerate() {
        let force = *mass * (*acceleration + DVec3::Y * GRAVITY);
        for axis in 0..3 {
            places.lane_mut(3 * index + axis)[0] = place[axis];
            forces.lane_mut(3 * index + axis)[0] = force[axis];
        }
    }
    LinkForces { places, forces, free_moments: vec![DVec3::ZERO] }
}

pub(crate) fn pose(k: usize) -> LinkForces {
    let links: Vec<_> = (0..LINKS)
        .map(|i| {
            let (place, acceleration) = link(i, k);
            (masses()[i], place, acceleration)
        })
        .collect();
    forces_of(&links)
}
