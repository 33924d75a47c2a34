//! Turns that give a somersault one momentum, against numbers computed elsewhere.

use cotillion::geometry::log;
use cotillion::physics::flight::momentum::Pair;
use cotillion::physics::flight::turning::{
    Aim, FRAME_STEPS, accumulated, end_preserving_momentum, mean_momentum, settled,
};
use glam::{DQuat, DVec3};

use crate::fixture::all_pairs;

/// Half a unit of the last digit stated, and rounding.
const DIGITS: f64 = 1e-6;

fn momenta(pairs: &[Pair], turns: &[DQuat]) -> Vec<DVec3> {
    let momentum = |(index, pair): (usize, &Pair)| pair.momentum([turns[index], turns[index + 1]]).value;
    pairs.iter().enumerate().map(momentum).collect()
}

fn raw(pairs: &[Pair]) -> Vec<DVec3> {
    momenta(pairs, &vec![DQuat::IDENTITY; pairs.len() + 1])
}

/// Mean and largest distance from `target`, as shares of it.
fn errors(momenta: &[DVec3], target: DVec3) -> (f64, f64) {
    let errors: Vec<f64> =
        momenta.iter().map(|momentum| momentum.distance(target) / target.length()).collect();
    (errors.iter().sum::<f64>() / errors.len() as f64, errors.into_iter().fold(0.0, f64::max))
}

fn degrees(turn: DQuat) -> f64 {
    log(turn).length().to_degrees()
}

#[test]
fn momenta_are_the_stated_ones() {
    let pairs = all_pairs();
    let momenta = raw(&pairs);
    let found = [momenta[0], momenta[12], momenta[23]].map(|momentum| momentum.x);
    for (own, stated) in found.into_iter().zip([42.250_858, 31.512_591, 44.716_030]) {
        assert!((own - stated).abs() < DIGITS, "{found:?}");
    }
    let mean = mean_momentum(&pairs);
    assert!((mean.x - 38.317_989).abs() < DIGITS, "{mean}");
    let (average, largest) = errors(&momenta, mean);
    assert!(
        (average - 0.175_417).abs() < DIGITS && (largest - 0.307_712).abs() < DIGITS,
        "{average} {largest}"
    );
}

#[test]
fn turning_each_frame_by_itself_mends_nothing() {
    let pairs = all_pairs();
    let mean = mean_momentum(&pairs);
    let none = DQuat::IDENTITY;
    // Each frame is turned against the one before it as it was.
    let alone: Vec<DQuat> = std::iter::once(none)
        .chain(pairs.iter().map(|pair| {
            let one = accumulated(std::slice::from_ref(pair), Aim { target: mean, share: 1.0 }, 1);
            one[1]
        }))
        .collect();
    let (average, _) = errors(&momenta(&pairs, &alone), mean);
    assert!((average - 0.167_952).abs() < DIGITS, "{average}");
}

#[test]
fn two_newton_steps_a_frame_are_enough() {
    let pairs = all_pairs();
    let target = mean_momentum(&pairs);
    let largest = |steps: usize| {
        let turns = accumulated(&pairs, Aim { target, share: 1.0 }, steps);
        (errors(&momenta(&pairs, &turns), target), degrees(turns[turns.len() - 1]))
    };
    let ((one, _), (two, turned)) = (largest(1), largest(2));
    // Means are stated.
    assert!((one.0 - 1.01e-3).abs() < 5e-6, "{one:?}");
    assert!((two.0 - 4.3e-8).abs() < 5e-10 && two.1 < 1e-6, "{two:?}");
    assert!((turned - 5.5398).abs() < 5e-5, "{turned}");
}

#[test]
fn the_target_that_keeps_the_end_nearly_does() {
    let pairs = all_pairs();
    let target = end_preserving_momentum(&pairs);
    assert!((target.x - 37.762_409).abs() < DIGITS, "{target}");
    let turns = accumulated(&pairs, Aim { target, share: 1.0 }, FRAME_STEPS);
    assert!((degrees(turns[turns.len() - 1]) - 0.3591).abs() < 5e-5);
}

#[test]
fn newton_on_the_target_keeps_the_end_in_two_steps() {
    let pairs = all_pairs();
    let mut own = settled(&pairs, 1.0);
    assert!(own.newton_steps <= 2 && own.keeps_end(), "{own:?}");
    own.ramp_off();
    assert_eq!(own.turns[pairs.len()], DQuat::IDENTITY);
    let (_, largest) = errors(&momenta(&pairs, &own.turns), own.aim.target);
    assert!(largest < 1e-8, "{largest:e}");
}

#[test]
fn resistance_is_how_momentum_depends_on_turns() {
    // By differences so small, and of a formula that leaves out how the turn between the frames bends: of second order in it.
    const BEND: f64 = 0.02;
    for pair in all_pairs() {
        let own = pair.momentum([DQuat::IDENTITY; 2]);
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let at = |angle: f64| {
                let turn = DQuat::from_axis_angle(axis, angle);
                pair.momentum([DQuat::IDENTITY, turn]).value * pair.step
            };
            let slope = (at(1e-5) - at(-1e-5)) / 2e-5;
            let off = slope.distance(own.resistance * axis);
            assert!(off < BEND * slope.length() + 0.5, "{slope} {}", own.resistance * axis);
        }
    }
}
