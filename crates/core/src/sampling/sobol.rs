//! Four dimensions of Sobol's sequence, shuffled and scrambled as by the library `sobol_burley`, whose
//! `sample_4d` gives the same bits. Its loop over the bits of an index is two look-ups here.

use sobol_burley::parts::{Int4, hash, hash_int4, owen_scramble_int4_rev, owen_scramble_rev};

/// How many points the sequence has.
pub(super) const POINTS: u32 = 1 << 16;

/// Point `index` < [`POINTS`] of the scrambling `seed`.
///
/// The point is the sum of the direction numbers of the index's bits, added without carry.
///
/// Source: Burley, *Practical Hash-based Owen Scrambling*, JCGT 9(4), 2020.
#[inline]
pub(super) fn scrambled(index: u32, seed: u32) -> [f32; 4] {
    // The order of bits is reversed throughout, so that what depends on the bits above depends on those below.
    let shuffled = owen_scramble_rev(index.reverse_bits(), hash(seed ^ 0x79c6_8e4a));
    let [low, high] = [shuffled >> 24, (shuffled >> 16) & 0xff].map(|byte| byte as usize);
    let point = Int4::from(SUMS[0][low]) ^ Int4::from(SUMS[1][high]);
    let dimensions = Int4::from([0x912f_69ba, 0x174f_18ab, 0x691e_72ca, 0xb40c_c1b8]);
    let scramble = hash_int4(Int4::from([seed.wrapping_mul(0x9c8f_2d3b); 4]) ^ dimensions);
    owen_scramble_int4_rev(point, scramble).reverse_bits().to_f32_norm()
}

/// For each value of the low and of the high byte of an index, bits reversed, the sum of its direction numbers in four
/// dimensions, bits reversed too.
static SUMS: [[[u32; 4]; 256]; 2] = sums();

const fn sums() -> [[[u32; 4]; 256]; 2] {
    let numbers = direction_numbers();
    let mut sums = [[[0; 4]; 256]; 2];
    let mut byte = 0;
    while byte < 2 {
        let mut value = 0;
        while value < 256 {
            let mut bit = 0;
            while bit < 8 {
                if value >> (7 - bit) & 1 == 1 {
                    let mut dimension = 0;
                    while dimension < 4 {
                        sums[byte][value][dimension] ^=
                            numbers[dimension][8 * byte + bit].reverse_bits();
                        dimension += 1;
                    }
                }
                bit += 1;
            }
            value += 1;
        }
        byte += 1;
    }
    sums
}

/// vₖ of four dimensions: van der Corput's, and those of the primitive polynomials x + 1, x² + x + 1 and x³ + x + 1
/// with the first numbers of Joe and Kuo, *Constructing Sobol Sequences with Better Two-Dimensional Projections*,
/// 2008.
const fn direction_numbers() -> [[u32; 16]; 4] {
    // Degree, inner coefficients, first numbers.
    const START: [(usize, u32, [u32; 3]); 3] =
        [(1, 0, [1, 0, 0]), (2, 1, [1, 3, 0]), (3, 1, [1, 3, 1])];
    let mut numbers = [[0; 16]; 4];
    let mut k = 0;
    while k < 16 {
        numbers[0][k] = 1 << (31 - k);
        let mut dimension = 0;
        while dimension < 3 {
            let (degree, inner, first) = START[dimension];
            let own = &mut numbers[dimension + 1];
            if k < degree {
                own[k] = first[k] << (31 - k);
            } else {
                own[k] = own[k - degree] ^ (own[k - degree] >> degree);
                let mut i = 1;
                while i < degree {
                    if inner >> (degree - 1 - i) & 1 == 1 {
                        own[k] ^= own[k - i];
                    }
                    i += 1;
                }
            }
            dimension += 1;
        }
        k += 1;
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The library's points, bit for bit: each tenth of many scramblings, and all of one.
    #[test]
    fn points_are_the_library_s() {
        for seed in (0..1000_u32).map(|k| k.wrapping_mul(0x9e37_79b9)) {
            for index in (seed % 977..POINTS).step_by(977) {
                assert_eq!(scrambled(index, seed), sobol_burley::sample_4d(index, 0, seed));
            }
        }
        for index in 0..POINTS {
            assert_eq!(scrambled(index, 77), sobol_burley::sample_4d(index, 0, 77), "{index}");
        }
    }
}
