//! How a walking foot leaves the ground and swings, over shares of its heel's rise and of its swing.

/// When the toes of a foot lift, in cycles from its strike.
pub(super) const TOE_OFF: f64 = 0.61;
/// Pitch of the foot then, radians, and its rate, radians per swing.
const TOE_OFF_PITCH: f64 = 1.05;
const LIFTING_RATE: f64 = 2.0;

/// Pitch of a foot after share `u` of its heel's rise, which takes `cycles`: it soon is too fast to be taken for standing.
pub(super) fn heel_rise(u: f64, cycles: f64) -> f64 {
    let last = LIFTING_RATE * cycles / (1.0 - TOE_OFF);
    u.powf(1.5) * (2.5 * TOE_OFF_PITCH - last + (last - 1.5 * TOE_OFF_PITCH) * u)
}

/// Share of the way ahead after share `u` of a swing: slow at first, while the toes rise.
pub(super) fn ahead(u: f64) -> f64 {
    u * u * (1.5 + u * (2.5 + u * (1.5 * u - 4.5)))
}

/// 1 half way, 0 at rest at both ends.
pub(super) fn bump(u: f64) -> f64 {
    16.0 * (u * (1.0 - u)).powi(2)
}

/// Turn of the toe joint in a swing: it straightens as the foot levels, so that the tip never hangs below the joint.
pub(super) fn swinging_toe(pitch: f64, u: f64) -> f64 {
    /// Width of the change from following the foot's pitch to none, radians.
    const BLEND: f64 = 0.30;
    -0.5 * (pitch + pitch.hypot(BLEND * bump(u)))
}

/// Pitch of a foot in a swing, from [`heel_rise`]'s last to that of its strike.
pub(super) fn swinging_pitch(strike: f64, u: f64) -> f64 {
    hermite([TOE_OFF_PITCH, strike], [LIFTING_RATE, 0.0], u)
}

/// Cubic on [0, 1] with the given values and slopes at its ends.
fn hermite(values: [f64; 2], slopes: [f64; 2], u: f64) -> f64 {
    let (v, w) = (1.0 - u, u);
    values[0] * v * v * (1.0 + 2.0 * w) + values[1] * w * w * (1.0 + 2.0 * v) + slopes[0] * w * v * v
        - slopes[1] * w * w * v
}
