//! What a careless editor, a broken disk, a foreign exporter or a stranger makes of a file.

use crate::random::Random;

const NUMBERS: [&str; 32] = [
    "0",
    "-1",
    "-0.0",
    "nan",
    "-inf",
    "inf",
    "1e400",
    "1e308",
    "1e51",
    "1e50",
    "-1e49",
    "1e39",
    "1e30",
    "16777217",
    "1e-17",
    "1e-50",
    "1e-160",
    "1e-320",
    "4294967296",
    "-9223372036854775808",
    "6148914691236517206",
    "123456789012345678901234567890",
    "0.999999999999999999999",
    "1.0",
    "1,5",
    "0x10",
    "1_000",
    "",
    "/",
    "//",
    "..",
    "\u{ff11}",
];

/// What has a meaning to one of the readers.
const STRUCTURE: [&[u8]; 32] = [
    b"\n",
    b"\r",
    b"\r\n",
    b"\\\n",
    b"\\",
    b"\t",
    b" ",
    b"#",
    b"\0",
    b"\xEF\xBB\xBF",
    b"\xFF\xFE",
    b"\xE9",
    b"\xC3\x28",
    b"\xE2\x80\xA8",
    b"\x1B[2J",
    b"\"",
    b"'''",
    b"[",
    b"]",
    b"[[",
    b"{",
    b"}",
    b"=",
    b".",
    b",",
    b"/",
    b"\nf ",
    b"\nv ",
    b"\nvn ",
    b"\nusemtl ",
    b"\nmtllib ../",
    b"\nnewmtl ",
];

/// One to three changes to `bytes`; pieces of the `donors` get into it.
pub fn mutate(bytes: &[u8], donors: &[&[u8]], random: &mut Random) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..1 + random.below(3) {
        change(&mut bytes, donors, random);
    }
    bytes
}

fn change(bytes: &mut Vec<u8>, donors: &[&[u8]], random: &mut Random) {
    let start = random.below(bytes.len() + 1);
    let end = (start + 1 + random.below(12)).min(bytes.len());
    match random.below(24) {
        0..=2 if start < bytes.len() => bytes[start] ^= 1 << random.below(8),
        3 if start < bytes.len() => bytes[start] = random.below(256) as u8,
        4..=5 => drop(bytes.drain(start..end)),
        6..=7 => {
            let copy = bytes[start..end].to_vec();
            let at = random.below(bytes.len() + 1);
            bytes.splice(at..at, copy);
        }
        8..=13 => replace_number(bytes, start, random),
        14..=16 => {
            bytes.splice(start..start, STRUCTURE[random.below(STRUCTURE.len())].iter().copied());
        }
        17..=18 => {
            let (from, to) = (line_around(bytes, start), random.below(bytes.len() + 1));
            let (line, to) = (bytes[from].to_vec(), line_around(bytes, to).start);
            bytes.splice(to..to, line);
        }
        19 => drop(bytes.drain(line_around(bytes, start))),
        20..=21 => {
            let donor = donors[random.below(donors.len())];
            let from = random.below(donor.len() + 1);
            let to = (from + random.below(200)).min(donor.len());
            bytes.splice(start..start, donor[from..to].iter().copied());
        }
        22 => bytes.truncate(start),
        // Rarely, since it is slow: a block or a byte, very often.
        _ if random.below(8) == 0 => {
            let line = line_around(bytes, start);
            let block = if random.below(2) == 0 { line } else { start..end };
            let copy = bytes[block].repeat(1 + random.below(2000));
            bytes.splice(start..start, copy);
        }
        _ => {}
    }
}

/// The line that holds the byte `at`, with its end.
fn line_around(bytes: &[u8], at: usize) -> std::ops::Range<usize> {
    let is_end = |&b: &u8| b == b'\n';
    let start = bytes[..at].iter().rposition(is_end).map_or(0, |i| i + 1);
    let end = bytes[at..].iter().position(is_end).map_or(bytes.len(), |i| at + i + 1);
    start..end
}

fn replace_number(bytes: &mut Vec<u8>, start: usize, random: &mut Random) {
    let is_digit = |b: &u8| b.is_ascii_digit();
    let first = bytes[start..].iter().position(is_digit).map_or(start, |i| start + i);
    let is_number = |b: &&u8| is_digit(b) || **b == b'.';
    let length = bytes[first..].iter().take_while(is_number).count();
    bytes.splice(first..first + length, NUMBERS[random.below(NUMBERS.len())].bytes());
}

/// Makes the checksums of a PNG's chunks right, as far as its chunks can be told.
pub fn repair_checksums(png: &mut [u8]) {
    let mut start = 8;
    while let Some(&[a, b, c, d]) = png.get(start..start + 4) {
        let end = start + 8 + u32::from_be_bytes([a, b, c, d]) as usize;
        let Some(chunk) = png.get(start + 4..end) else { return };
        let checksum = crc32(chunk).to_be_bytes();
        let Some(place) = png.get_mut(end..end + 4) else { return };
        place.copy_from_slice(&checksum);
        start = end + 4;
    }
}

/// The checksum of ISO 3309, which PNG uses.
fn crc32(bytes: &[u8]) -> u32 {
    let bit = |crc: u32| (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg());
    let byte = |crc: u32, &byte: &u8| (0..8).fold(crc ^ u32::from(byte), |crc, _| bit(crc));
    !bytes.iter().fold(!0, byte)
}
