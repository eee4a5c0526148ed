//! Readers of files, on thousands of files that are nearly sound: no panic, no hang, bounded memory. `cargo xtask fuzz` searches
//! longer, and knows which bytes matter.

use peelnet_core::random::Random;
use peelnet_tests::readers::READERS;
use std::time::{Duration, Instant};

/// Files for each reader.
const FILES: u64 = 3000;

/// No file of a few kilobytes needs longer, on any machine, by a factor of a hundred.
const LONGEST: Duration = Duration::from_secs(10);

/// Numbers that break what counts with them.
const NUMBERS: &str =
    "0 -1 1e30 -1e30 nan inf 4294967295 18446744073709551615 -9223372036854775808 1e-45";

/// Words that formats are made of.
const WORDS: &str = "\n|\0|[|]|{|}|\"|=|f 1 2 3\n|count = 4000000000\n|triangles = 4000000000|\
    grid = [9999, 9999, 9999]\n|\"rows\": 99999999999|[[scatter]]\n";

/// A file with some of its bytes changed, removed, doubled, or replaced by a word.
fn mutate(sound: &[u8], random: &mut Random) -> Vec<u8> {
    let numbers: Vec<&str> = NUMBERS.split(' ').collect();
    let words: Vec<&str> = WORDS.split('|').chain(NUMBERS.split(' ')).collect();
    let mut bytes = sound.to_vec();
    for _ in 0..1 + random.below(4) {
        let at = random.below(bytes.len() + 1);
        let end = (at + random.below(24)).min(bytes.len());
        match random.below(7) {
            0 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
            1 if at < bytes.len() => bytes[at] = random.below(256) as u8,
            2 => bytes.truncate(at),
            3 => drop(bytes.drain(at..end)),
            4 => {
                let again: Vec<u8> = bytes[at..end].to_vec();
                bytes.splice(at..at, again);
            }
            5 => {
                // A number, where there is one, becomes another.
                let digit = |b: &u8| b.is_ascii_digit();
                if let Some(from) = bytes[at..].iter().position(digit).map(|k| at + k) {
                    let length = bytes[from..].iter().take_while(|b| digit(b)).count();
                    let word = numbers[random.below(numbers.len())].bytes();
                    bytes.splice(from..from + length, word);
                }
            }
            _ => {
                let word = words[random.below(words.len())].bytes();
                bytes.splice(at..end, word);
            }
        }
    }
    bytes
}

fn search(name: &str) {
    let (_, read, seeds) = READERS.iter().find(|(known, ..)| *known == name).unwrap();
    let seeds = seeds();
    for sound in &seeds {
        read(sound);
    }
    for k in 0..FILES {
        let mut random = Random::new(k, &[name.len() as u64]);
        let bytes = mutate(&seeds[random.below(seeds.len())], &mut random);
        let start = Instant::now();
        let read = std::panic::catch_unwind(|| read(&bytes));
        let (took, text) = (start.elapsed(), String::from_utf8_lossy(&bytes));
        let is_sound = read.is_ok() && took < LONGEST;
        assert!(is_sound, "{name} {k}: {took:?} for {text:?}");
    }
    if let Some(most) = peak_memory() {
        assert!(most < 1 << 30, "{most} bytes for files of kilobytes");
    }
}

/// The most memory that this process had, where the system says it.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    let kilobytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes << 10)
}

macro_rules! readers {
    ($($name:ident),*) => { $(#[test] fn $name() { search(stringify!($name)); })* };
}

readers!(
    scene, obj, dataset, model, gltf, ply, stl, texture, results, splat, spz
);
