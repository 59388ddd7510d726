//! Mutations of valid inputs.

use crate::random::Random;

/// Numbers at the limits of types and formats.
const NUMBERS: [&str; 18] = [
    "0",
    "-1",
    "1",
    "255",
    "256",
    "65536",
    "2147483648",
    "4294967295",
    "4294967296",
    "18446744073709551615",
    "9223372036854775808",
    "1e308",
    "1e309",
    "-1e-320",
    "nan",
    "inf",
    "-inf",
    "0.1",
];

/// Counts that no file of a few kilobytes can hold.
const COUNTS: [u64; 5] = [1 << 24, 500_000_000, (1 << 31) - 1, (1 << 32) - 1, 1 << 40];
/// Factors of coordinates and other numbers of a text.
const FACTORS: [f64; 6] = [1e-12, 1e-6, 1e6, 1e12, 1e300, -1.0];
/// Strings in names of a mesh or a case that must not act on a terminal or a spreadsheet.
const SIGNS: [&str; 6] = ["\u{1b}[31m", "\u{7}", "=1+1", "\u{202e}", "\r", "\u{0}"];
/// Largest number of sets in a chain.
const CHAIN: usize = 40;

/// Makes inputs from others.
pub struct Mutator {
    random: Random,
    words: Vec<String>,
}

impl Mutator {
    /// A mutator that inserts these words.
    pub fn new(random: Random, words: Vec<String>) -> Mutator {
        Mutator { random, words }
    }

    /// A mutation of one of the inputs, of at most `longest` bytes.
    pub fn mutate(&mut self, corpus: &[Vec<u8>], longest: usize) -> Vec<u8> {
        let mut bytes = self.one(corpus);
        let times = 1 + self.below(4);
        for _ in 0..times {
            self.change(&mut bytes, corpus);
        }
        bytes.truncate(longest);
        bytes
    }

    fn below(&mut self, count: usize) -> usize {
        ((self.random.number() * count as f64) as usize).min(count.saturating_sub(1))
    }

    fn one(&mut self, corpus: &[Vec<u8>]) -> Vec<u8> {
        let at = self.below(corpus.len());
        corpus.get(at).cloned().unwrap_or_default()
    }

    /// A random range of an input.
    fn range(&mut self, length: usize, most: usize) -> std::ops::Range<usize> {
        let from = self.below(length + 1);
        from..(from + 1 + self.below(most)).min(length).max(from)
    }

    fn change(&mut self, bytes: &mut Vec<u8>, corpus: &[Vec<u8>]) {
        let length = bytes.len();
        let at = self.below(length + 1);
        match self.below(13) {
            0 => {
                let bit = self.below(8);
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << bit;
                }
            }
            1 => {
                let value = self.below(256) as u8;
                if let Some(byte) = bytes.get_mut(at) {
                    *byte = value;
                }
            }
            2 => drop(bytes.drain(self.range(length, 60))),
            3 => {
                let copied = bytes[self.range(length, 200)].to_vec();
                drop(bytes.splice(at..at, copied));
            }
            4 => {
                let word = self.below(self.words.len());
                let word = self.words.get(word).cloned().unwrap_or_default();
                drop(bytes.splice(at..at, word.into_bytes()));
            }
            5 => self.renumber(bytes),
            6 => bytes.truncate(at),
            7 => {
                let other = self.one(corpus);
                let part = other[self.range(other.len(), 400)].to_vec();
                let place = self.range(length, 100);
                drop(bytes.splice(place, part));
            }
            8 => self.announce(bytes),
            9 => self.scale(bytes),
            10 => self.chain(bytes),
            11 => {
                let sign = self.random.of(&SIGNS);
                drop(bytes.splice(at..at, sign.bytes()));
            }
            _ => {
                let value = self.random.of(&[0u8, 1, 0x7f, 0x80, 0xff]);
                for byte in bytes.iter_mut().skip(at).take(8) {
                    *byte = value;
                }
            }
        }
    }

    /// Replaces a number in a text by another one.
    fn renumber(&mut self, bytes: &mut Vec<u8>) {
        let from = self.below(bytes.len() + 1);
        let Some(start) = bytes.iter().skip(from).position(u8::is_ascii_digit).map(|at| from + at) else { return };
        let digits = bytes[start..].iter().take_while(|b| b.is_ascii_digit() || **b == b'.').count();
        let number = self.random.of(&NUMBERS);
        drop(bytes.splice(start..start + digits, number.bytes()));
    }

    /// Announces more data than exist: a small number of a binary file, aligned to four bytes, becomes a large one.
    fn announce(&mut self, bytes: &mut [u8]) {
        let words = bytes.len() / 4;
        let from = self.below(words + 1);
        let count = |bytes: &[u8], word: usize| {
            bytes.get(4 * word..4 * word + 4).map(|of| u32::from_le_bytes([of[0], of[1], of[2], of[3]]))
        };
        let is_count = |word: &usize| count(bytes, *word).is_some_and(|count| (1..=0xffff).contains(&count));
        let Some(word) = (from..words).find(is_count) else { return };
        let many = self.random.of(&COUNTS).to_le_bytes();
        let long = if self.below(2) == 0 { 4 } else { 8 };
        for (byte, of_many) in bytes.iter_mut().skip(4 * word).zip(many.iter().take(long)) {
            *byte = *of_many;
        }
    }

    /// Scales a number of a text: cells become slivers, bodies move far apart.
    fn scale(&mut self, bytes: &mut Vec<u8>) {
        let from = self.below(bytes.len() + 1);
        let Some(start) = bytes.iter().skip(from).position(u8::is_ascii_digit).map(|at| from + at) else { return };
        let digits = bytes[start..].iter().take_while(|b| b.is_ascii_digit() || b".eE+-".contains(b)).count();
        let number = std::str::from_utf8(&bytes[start..start + digits]).ok().and_then(|text| text.parse::<f64>().ok());
        let Some(number) = number else { return };
        let scaled = format!("{:e}", number * self.random.of(&FACTORS));
        drop(bytes.splice(start..start + digits, scaled.into_bytes()));
    }

    /// Appends sets of sets to an Abaqus model, each with several references to the one before.
    fn chain(&mut self, bytes: &mut Vec<u8>) {
        let kind = self.random.of(&["NSET", "ELSET"]);
        let text = String::from_utf8_lossy(bytes).into_owned();
        let names: Vec<&str> = text.split(&format!("{kind}=")).skip(1).filter_map(|rest| rest.lines().next()).collect();
        let Some(first) = names.get(self.below(names.len())) else { return };
        let mut before = first.split(',').next().unwrap_or_default().to_owned();
        for number in 0..=self.below(CHAIN) {
            let name = format!("Q{number}");
            bytes.extend(format!("*{kind}, {kind}={name}\n{before}, {before}, {before}\n").bytes());
            before = name;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mutator() -> Mutator {
        Mutator::new(Random::new(7), Vec::new())
    }

    #[test]
    fn counts_are_announced() {
        let mut bytes = vec![0u8; 64];
        bytes[32..36].copy_from_slice(&12u32.to_le_bytes());
        let mut mutator = mutator();
        let mut announced = || {
            let mut other = bytes.clone();
            mutator.announce(&mut other);
            u64::from_le_bytes(std::array::from_fn(|i| other[32 + i]))
        };
        assert!((0..100).any(|_| announced() > 0xffff_ffff) && (0..100).any(|_| announced() == 500_000_000));
    }

    #[test]
    fn numbers_are_scaled_and_sets_are_chained() {
        let mut mutator = mutator();
        let scaled = (0..60).any(|_| {
            let mut text = b"1, 0.5, 2.0\n".to_vec();
            mutator.scale(&mut text);
            String::from_utf8_lossy(&text).contains("e-12") || String::from_utf8_lossy(&text).contains("e-7")
        });
        assert!(scaled);
        let chained = (0..60).any(|_| {
            let mut text = b"*NSET, NSET=LOW\n1, 2\n".to_vec();
            mutator.chain(&mut text);
            String::from_utf8_lossy(&text).contains("*NSET, NSET=Q9\nQ8, Q8, Q8\n")
        });
        assert!(chained);
    }
}
