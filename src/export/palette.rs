//! Colours that tell characters apart, also for people who see few of them.

/// sRGB of character `index`: eight hues that colour-blind people can tell apart, darker each time round.
///
/// Source of the hues: Okabe & Ito, *Color Universal Design* (2008), with yellow and black replaced, which are hard to
/// see on white or taken by text.
pub(super) fn colour(index: usize) -> [u8; 3] {
    const HUES: [[u8; 3]; 8] = [
        [0, 114, 178],
        [213, 94, 0],
        [0, 158, 115],
        [204, 121, 167],
        [86, 180, 233],
        [184, 134, 11],
        [117, 76, 165],
        [140, 86, 60],
    ];
    let round = index / HUES.len();
    let shade = [1.0, 0.68, 0.45][round % 3];
    HUES[index % HUES.len()].map(|channel| scaled(channel, shade))
}

/// sRGB of a share from 0 to 1 of something that goes on, such as time: hues that follow each other, all dark enough for thin
/// lines on white.
pub(super) fn ramp(share: f64) -> [f64; 3] {
    const STOPS: [[f64; 3]; 6] = [
        [70.0, 30.0, 120.0],
        [40.0, 90.0, 175.0],
        [0.0, 140.0, 140.0],
        [80.0, 150.0, 40.0],
        [205.0, 140.0, 0.0],
        [200.0, 50.0, 40.0],
    ];
    let at = share.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let stop = (0..STOPS.len() - 1).rev().find(|stop| at >= *stop as f64).unwrap_or(0);
    let between = at - stop as f64;
    std::array::from_fn(|k| STOPS[stop][k] + between * (STOPS[stop + 1][k] - STOPS[stop][k]))
}

/// A channel made darker.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 0 and 255 by its factors"
)]
fn scaled(channel: u8, shade: f64) -> u8 {
    (f64::from(channel) * shade).round() as u8
}

/// The sRGB channel as linear light, 0 to 1.
///
/// Source: IEC 61966-2-1.
pub(super) fn linear(channel: u8) -> f64 {
    let c = f64::from(channel) / 255.0;
    if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}
