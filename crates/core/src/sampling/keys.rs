//! Well-mixed keys, from which random numbers follow.

/// A well-mixed key for each (seed, pixel): the finaliser of SplitMix64 (Steele, Lea, Flood 2014).
pub(super) fn pixel_key(seed: u64, x: u32, y: u32) -> u64 {
    let pixel = (u64::from(y) << 32) | u64::from(x);
    mix(mix(seed).wrapping_add(pixel.wrapping_mul(STEP)))
}

/// 2⁶⁴ divided by the golden ratio, SplitMix64's own step: it keeps zeros from staying zeros.
pub(super) const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

pub(super) fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
