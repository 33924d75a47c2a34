//! Choices: each a function of the seed, of what is chosen, and for whom.

/// What is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// How tall a carrier is.
    CarrierHeight,
    /// How tall a disturber is.
    DisturberHeight,
    /// How a carrier comes to the box.
    Coming,
    /// How a disturber disturbs.
    Disturbance,
    /// On which side of the carrier.
    Side,
    /// How early or late a disturber is.
    Lateness,
    /// When a box sets off.
    Beginning,
}

/// 64 bits for `choice` about number `index`.
///
/// Source: Steele, Lea, Flood, *Fast Splittable Pseudorandom Number Generators*, OOPSLA 2014 (the mixing of SplitMix64).
pub fn bits(seed: u64, choice: Choice, index: usize) -> u64 {
    const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
    let stream = mix(seed.wrapping_add(GOLDEN.wrapping_mul(choice as u64 + 1)));
    mix(stream.wrapping_add(GOLDEN.wrapping_mul(index as u64 + 1)))
}

const fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// One of 0 to `count` − 1; 0 where there is nothing to choose from.
pub fn below(count: usize, seed: u64, choice: Choice, index: usize) -> usize {
    let scaled = (u128::from(bits(seed, choice, index)) * count as u128) >> 64;
    usize::try_from(scaled).unwrap_or(0)
}

/// Between −1 and 1.
pub fn signed(seed: u64, choice: Choice, index: usize) -> f64 {
    let steps = u32::try_from(bits(seed, choice, index) >> 33).unwrap_or(0);
    f64::from(steps) / f64::from(1_u32 << 30) - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_spread_and_do_not_depend_on_each_other() {
        let mut counts = [0; 5];
        (0..5000).for_each(|index| counts[below(5, 7, Choice::CarrierHeight, index)] += 1);
        // Five standard deviations of a count of 1000 in 5000.
        assert!(counts.iter().all(|count| (860..1140).contains(count)), "{counts:?}");
        let same = (0..1000)
            .filter(|index| below(2, 7, Choice::Side, *index) == below(2, 7, Choice::Coming, *index));
        assert!((420..580).contains(&same.count()));
        assert!((0..1000).all(|index| signed(3, Choice::Lateness, index).abs() <= 1.0));
        assert_eq!(below(0, 7, Choice::Side, 3), 0);
    }

    #[test]
    fn the_mixing_is_that_of_the_source() {
        // First outputs of SplitMix64 from seed 0, as widely published.
        const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
        assert_eq!(mix(GOLDEN), 0xe220_a839_7b1d_cdaf);
        assert_eq!(mix(GOLDEN.wrapping_mul(2)), 0x6e78_9e6a_a1b9_65f4);
    }
}
