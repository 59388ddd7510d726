//! Mutations of sound inputs.

use crate::random::Random;

/// Numbers at the ends of what types and formats hold.
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

/// Makes inputs of others.
pub struct Mutator {
    random: Random,
    words: Vec<String>,
}

impl Mutator {
    /// Mutations that put in some words.
    pub fn new(random: Random, words: Vec<String>) -> Mutator {
        Mutator { random, words }
    }

    /// A mutation of one of the inputs, of at most so many bytes.
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

    /// A range of an input.
    fn range(&mut self, length: usize, most: usize) -> std::ops::Range<usize> {
        let from = self.below(length + 1);
        from..(from + 1 + self.below(most)).min(length).max(from)
    }

    fn change(&mut self, bytes: &mut Vec<u8>, corpus: &[Vec<u8>]) {
        let length = bytes.len();
        let at = self.below(length + 1);
        match self.below(9) {
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
            _ => {
                let value = self.random.of(&[0u8, 1, 0x7f, 0x80, 0xff]);
                for byte in bytes.iter_mut().skip(at).take(8) {
                    *byte = value;
                }
            }
        }
    }

    /// Puts another number in the place of one in a text.
    fn renumber(&mut self, bytes: &mut Vec<u8>) {
        let from = self.below(bytes.len() + 1);
        let Some(start) = bytes.iter().skip(from).position(u8::is_ascii_digit).map(|at| from + at) else { return };
        let digits = bytes[start..].iter().take_while(|b| b.is_ascii_digit() || **b == b'.').count();
        let number = self.random.of(&NUMBERS);
        drop(bytes.splice(start..start + digits, number.bytes()));
    }
}
