//! Capital letters on a grid of 5 × 7 squares.

use glam::{IVec2, Vec2};

/// Squares of a letter, with its margins.
const SQUARES: Vec2 = Vec2::new(7.0, 9.0);

/// The share of cells that are spaces between words.
const SPACES: f32 = 0.15;

/// Letters of a line of [`LETTERS`], and of both.
const ACROSS: usize = 12;
const COUNT: usize = 24;

/// Two lines of letters, seven rows each.
const LETTERS: [&str; 14] = [
    ".###. ####. .###. ####. ##### ##### .###. #...# .###. #...# #.... #...#",
    "#...# #...# #...# #...# #.... #.... #...# #...# ..#.. #..#. #.... ##.##",
    "#...# #...# #.... #...# #.... #.... #.... #...# ..#.. #.#.. #.... #.#.#",
    "##### ####. #.... #...# ####. ####. #.### ##### ..#.. ##... #.... #.#.#",
    "#...# #...# #.... #...# #.... #.... #...# #...# ..#.. #.#.. #.... #...#",
    "#...# #...# #...# #...# #.... #.... #...# #...# ..#.. #..#. #.... #...#",
    "#...# ####. .###. ####. ##### #.... .###. #...# .###. #...# ##### #...#",
    // The second line.
    "#...# .###. ####. ####. .#### ##### #...# #...# #...# #...# #...# #####",
    "##..# #...# #...# #...# #.... ..#.. #...# #...# #...# #...# #...# ....#",
    "##..# #...# #...# #...# #.... ..#.. #...# #...# #...# .#.#. .#.#. ...#.",
    "#.#.# #...# ####. ####. .###. ..#.. #...# #...# #.#.# ..#.. ..#.. ..#..",
    "#..## #...# #.... #.#.. ....# ..#.. #...# #...# #.#.# .#.#. ..#.. .#...",
    "#..## #...# #.... #..#. ....# ..#.. #...# .#.#. ##.## #...# ..#.. #....",
    "#...# .###. #.... #...# ####. ..#.. .###. ..#.. #...# #...# ..#.. #####",
];

/// 1 on the letter of a place's cell, else 0. `number` is a cell's random number of 0 … 1.
pub(super) fn ink(place: Vec2, number: impl Fn(IVec2) -> f32) -> f32 {
    let cell = place.floor();
    let drawn = number(cell.as_ivec2());
    if drawn < SPACES {
        return 0.0;
    }
    let letter = ((drawn - SPACES) / (1.0 - SPACES) * COUNT as f32) as usize;
    let letter = letter.min(COUNT - 1);
    let square = ((place - cell) * SQUARES).as_ivec2() - IVec2::ONE;
    if !(0..5).contains(&square.x) || !(0..7).contains(&square.y) {
        return 0.0;
    }
    let row = LETTERS[letter / ACROSS * 7 + square.y as usize].as_bytes();
    let is_ink = row[letter % ACROSS * 6 + square.x as usize] == b'#';
    if is_ink { 1.0 } else { 0.0 }
}
