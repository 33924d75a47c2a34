//! What holds of every flight, whoever flies it.

use cotillion::clip::Clip;
use cotillion::geometry::{exp, log, yaw};
use cotillion::physics::GRAVITY;
use cotillion::physics::flight::{FlightSettings, Flown, MomentumTarget, fly, halves_in_turn};
use cotillion::physics::input::InputError;
use cotillion::physics::posed::{PosedClip, centers_of_mass, link_places};
use cotillion::physics::stages::{Phase, Stages};
use glam::{DQuat, DVec3};
use proptest::prelude::*;

use crate::fixture::{FPS, FRAMES, body, clip};

/// Of the momentum: what is promised.
const MOMENTUM_KEPT: f64 = 1e-6;
/// Metres: what is promised.
const ON_PARABOLA: f64 = 1e-6;
/// Rounding of some thousand operations on metres and radians, and what Newton's method leaves.
const SAME: f64 = 1e-6;

/// First and last frame in the air.
const AIR: (usize, usize) = (3, 20);

/// Stages of a clip whose frames `air` fly.
fn stages(air: &[(usize, usize)]) -> Stages {
    let phase = |frame: usize| match air.iter().any(|(first, last)| (*first..=*last).contains(&frame)) {
        true => Phase::Flight,
        false => Phase::Ground,
    };
    Stages {
        soles: Vec::new(),
        supports: Vec::new(),
        phases: (0..FRAMES).map(phase).collect(),
        flights: Vec::new(),
    }
}

/// The somersault, shaken: turned and moved by waves of `sizes` and `rates`.
fn shaken(waves: &[[f64; 2]]) -> Clip {
    let mut clip = clip();
    let vector = |at: usize, time: f64| {
        DVec3::from_array(std::array::from_fn(|axis| {
            let [size, rate] = waves[(at + axis) % waves.len()];
            size * (rate * time + at as f64 + 2.0 * axis as f64).sin()
        }))
    };
    for frame in 0..FRAMES {
        let time = frame as f64 / FPS;
        clip.root_positions[frame] += 0.1 * vector(0, time);
        for joint in 0..3 {
            let rotation = &mut clip.rotations[3 * frame + joint];
            *rotation = exp(vector(3 * joint, time)) * *rotation;
        }
    }
    clip
}

fn flown(clip: &Clip, air: &[(usize, usize)], settings: &FlightSettings) -> Flown {
    fly(clip, &body(), &stages(air), settings).expect("a sound clip")
}

/// Momentum from frame to frame, written out link by link.
fn momenta(clip: &Clip) -> Vec<DVec3> {
    let (body, posed) = (body(), PosedClip::of(clip));
    let places = link_places(&body, &posed);
    let centers = centers_of_mass(&body, &places);
    let pair = |frame: usize| -> DVec3 {
        let link = |(index, link): (usize, &cotillion::physics::body_model::Link)| {
            let [from, to] = [frame, frame + 1].map(|at| posed.at(at, link.joint).rotation);
            let [before, after] = [frame, frame + 1].map(|at| places.vector(index, at) - centers[at]);
            let turn = log(to * from.inverse());
            let half = exp(0.5 * turn) * from;
            let spin = half * (link.inertia * (half.inverse() * turn));
            (spin + link.mass * before.cross(after)) * FPS
        };
        body.links.iter().enumerate().map(link).sum()
    };
    (0..FRAMES - 1).map(pair).collect()
}

/// Farthest of the momenta in `air` (borders with it) from their mean, kg m²/s, and the mean.
fn momentum_spread(clip: &Clip, (first, last): (usize, usize)) -> (f64, DVec3) {
    let momenta = &momenta(clip)[first.saturating_sub(1)..=last.min(FRAMES - 2)];
    let mean = momenta.iter().sum::<DVec3>() / momenta.len() as f64;
    (momenta.iter().map(|momentum| momentum.distance(mean)).fold(0.0, f64::max), mean)
}

/// Farthest of the second differences of the centre of mass in `air` from gravity's, metres.
fn fall_error(clip: &Clip, (first, last): (usize, usize)) -> f64 {
    let body = body();
    let centers = centers_of_mass(&body, &link_places(&body, &PosedClip::of(clip)));
    let off =
        |three: &[DVec3]| (three[2] - 2.0 * three[1] + three[0] + DVec3::Y * GRAVITY / FPS / FPS).length();
    let own = &centers[first.saturating_sub(1)..=(last + 1).min(FRAMES - 1)];
    own.windows(3).map(off).fold(0.0, f64::max)
}

fn distance(a: &Clip, b: &Clip) -> f64 {
    let places = a.root_positions.iter().zip(&b.root_positions).map(|(a, b)| a.distance(*b));
    let turns = a.rotations.iter().zip(&b.rotations).map(|(a, b)| log(*a * b.inverse()).length());
    places.chain(turns).fold(0.0, f64::max)
}

/// True gravity, whatever a shaken body falls like.
fn by_gravity() -> FlightSettings {
    FlightSettings { trusts_fall: false, ..FlightSettings::default() }
}

/// A somersault of a thin body now and then meets momenta that turn its end nowhere: there is no exact answer then.
fn is_whole(flown: &Flown) -> bool {
    flown.report.flights.iter().all(|facts| facts.share == 1.0)
}

fn waves() -> impl Strategy<Value = Vec<[f64; 2]>> {
    prop::collection::vec([0.0..0.1_f64, 1.0..8.0_f64], 5)
}

/// So wild that the thin body would tumble.
fn wild_waves() -> impl Strategy<Value = Vec<[f64; 2]>> {
    prop::collection::vec([0.1..0.5_f64, 3.0..15.0_f64], 5)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn momentum_is_constant_and_the_fall_a_parabola(waves in waves()) {
        let flown = flown(&shaken(&waves), &[AIR], &by_gravity());
        prop_assume!(is_whole(&flown));
        let (spread, mean) = momentum_spread(&flown.clip, AIR);
        prop_assert!(spread < MOMENTUM_KEPT * mean.length(), "{spread:e} of {mean}");
        prop_assert!(fall_error(&flown.clip, AIR) < ON_PARABOLA);
        let facts = &flown.report.flights[0];
        prop_assert!(facts.momentum_errors[1] < MOMENTUM_KEPT * mean.length());
        prop_assert!(facts.center_errors[1] < ON_PARABOLA);
        prop_assert!(facts.momentum.distance(mean) < MOMENTUM_KEPT * mean.length());
    }

    #[test]
    fn the_ground_stays_as_it_was_to_the_bit(waves in prop_oneof![waves(), wild_waves()], with_halves in any::<bool>()) {
        let clip = shaken(&waves);
        let steps = if with_halves { halves_in_turn() } else { Vec::new() };
        let flown = flown(&clip, &[AIR], &FlightSettings { steps, ..by_gravity() });
        prop_assert!(flown.report.flights[0].borders_kept);
        for frame in (0..AIR.0).chain(AIR.1 + 1..FRAMES) {
            prop_assert_eq!(flown.clip.root_positions[frame], clip.root_positions[frame]);
            prop_assert_eq!(&flown.clip.rotations[3 * frame..][..3], &clip.rotations[3 * frame..][..3]);
        }
    }

    #[test]
    fn who_would_tumble_is_not_broken(waves in wild_waves()) {
        let clip = shaken(&waves);
        let flown = flown(&clip, &[AIR], &by_gravity());
        let facts = &flown.report.flights[0];
        prop_assert!(fall_error(&flown.clip, AIR) < ON_PARABOLA);
        prop_assert!((0.0..=1.0).contains(&facts.share));
        let is_kept = facts.momentum_errors[1] < MOMENTUM_KEPT * facts.momentum.length();
        prop_assert_eq!(is_kept, facts.share == 1.0);
        prop_assert!(facts.momentum_errors[1] < facts.momentum_errors[0] * (1.0 + SAME));
    }

    #[test]
    fn who_is_turned_and_moved_flies_as_before(waves in waves(), turn in -3.0..3.0_f64, to in [-5.0..5.0_f64, -5.0..5.0]) {
        let move_by = |clip: &Clip| {
            let mut moved = clip.clone();
            for frame in 0..FRAMES {
                let root = &mut moved.root_positions[frame];
                *root = yaw(turn) * *root + DVec3::new(to[0], 0.0, to[1]);
                let rotation = &mut moved.rotations[3 * frame];
                *rotation = yaw(turn) * *rotation;
            }
            moved
        };
        let clip = shaken(&waves);
        let own = flown(&clip, &[AIR], &by_gravity());
        prop_assume!(is_whole(&own));
        let first = move_by(&own.clip);
        let last = flown(&move_by(&clip), &[AIR], &by_gravity()).clip;
        prop_assert!(distance(&first, &last) < SAME, "{:e}", distance(&first, &last));
    }

    #[test]
    fn heavier_bodies_fly_alike(waves in waves(), factor in 0.3..3.0_f64) {
        let clip = shaken(&waves);
        let masses: Vec<f64> = body().links.iter().map(|link| factor * link.mass).collect();
        let heavy = body().with_link_masses(&masses);
        let heavier = fly(&clip, &heavy, &stages(&[AIR]), &by_gravity()).expect("a sound clip");
        let own = flown(&clip, &[AIR], &by_gravity());
        prop_assume!(is_whole(&own));
        prop_assert!(distance(&own.clip, &heavier.clip) < SAME);
    }

    #[test]
    fn a_clip_may_start_and_end_in_the_air(waves in waves(), from in 0..2_usize, to in 0..2_usize) {
        let air = (4 * from, FRAMES - 1 - 4 * to);
        let clip = shaken(&waves);
        let flown = flown(&clip, &[air], &by_gravity());
        prop_assume!(is_whole(&flown));
        let (spread, mean) = momentum_spread(&flown.clip, air);
        prop_assert!(spread < MOMENTUM_KEPT * mean.length(), "{spread:e} of {mean}");
        prop_assert!(fall_error(&flown.clip, air) < ON_PARABOLA);
        for frame in (0..air.0).chain(air.1 + 1..FRAMES) {
            prop_assert_eq!(flown.clip.root_positions[frame], clip.root_positions[frame]);
        }
    }

    #[test]
    fn a_touch_between_two_flights_is_kept(waves in waves()) {
        let air = [(2, 10), (12, 21)];
        let clip = shaken(&waves);
        let flown = flown(&clip, &air, &by_gravity());
        prop_assume!(is_whole(&flown));
        for air in air {
            let (spread, mean) = momentum_spread(&flown.clip, air);
            let fall = fall_error(&flown.clip, air);
            prop_assert!(spread < MOMENTUM_KEPT * mean.length() && fall < ON_PARABOLA);
        }
        prop_assert_eq!(flown.clip.root_positions[11], clip.root_positions[11]);
        prop_assert_eq!(&flown.clip.rotations[33..36], &clip.rotations[33..36]);
    }

    #[test]
    fn the_mean_momentum_is_kept_as_well_and_neighbours_fade_the_rest_out(waves in waves()) {
        let clip = shaken(&waves);
        let settings = FlightSettings { target: MomentumTarget::Mean, fade: 0.1, ..by_gravity() };
        let flown = flown(&clip, &[AIR], &settings);
        let (spread, mean) = momentum_spread(&flown.clip, AIR);
        prop_assert!(spread < MOMENTUM_KEPT * mean.length() && fall_error(&flown.clip, AIR) < ON_PARABOLA);
        // Three frames fade; the fourth is as it was.
        let [before, after] = flown.report.flights[0].border_turns;
        prop_assert_eq!(before, 0.0);
        let turned = |frame: usize| log(flown.clip.rotations[3 * frame] * clip.rotations[3 * frame].inverse()).length();
        prop_assert!((turned(AIR.1 + 1) - after).abs() < SAME);
        prop_assert!(turned(AIR.1 + 2) < after + SAME && turned(AIR.1 + 3) < turned(AIR.1 + 2) + SAME);
        prop_assert_eq!(&flown.clip.rotations[3 * (AIR.1 + 4)..], &clip.rotations[3 * (AIR.1 + 4)..]);
    }
}

#[test]
fn what_flies_already_is_left_alone() {
    let own = flown(&clip(), &[AIR], &by_gravity()).clip;
    let again = flown(&own, &[AIR], &by_gravity());
    assert!(distance(&own, &again.clip) < SAME);
    assert_eq!(again.report.flights[0].newton_steps, 0);
}

#[test]
fn a_clip_on_the_ground_comes_out_to_the_bit() {
    let clip = clip();
    let flown = flown(&clip, &[], &FlightSettings::default());
    assert_eq!(flown.clip, clip);
    assert!(flown.report.flights.is_empty());
}

#[test]
fn what_is_no_number_is_an_error() {
    let mut broken = clip();
    broken.rotations[7] = DQuat::from_xyzw(f64::NAN, 0.0, 0.0, 1.0);
    let refused = fly(&broken, &body(), &stages(&[AIR]), &FlightSettings::default());
    assert_eq!(refused, Err(InputError::NotFinite { what: "every rotation" }));
    let settings = FlightSettings { fade: f64::INFINITY, ..FlightSettings::default() };
    let refused = fly(&clip(), &body(), &stages(&[AIR]), &settings);
    assert_eq!(refused, Err(InputError::NotFinite { what: "the fade" }));
    let mut short = stages(&[AIR]);
    short.phases.pop();
    let refused = fly(&clip(), &body(), &short, &FlightSettings::default());
    assert_eq!(refused, Err(InputError::OtherStages { stages: FRAMES - 1, frames: FRAMES }));
}
