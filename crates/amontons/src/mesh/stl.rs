//! Surfaces of triangles from STL files, text or binary: the boundary of a rigid obstacle.
//!
//! A binary file has a header of 80 bytes, the number of its triangles, and 50 bytes per triangle: a normal, three
//! corners (little-endian numbers of four bytes) and two more bytes. Normals are ignored, as they follow from the
//! corners.

use super::read::{FilePosition, MeshFileError};
use crate::tensor::Point;

/// Bytes before the triangles of a binary file, and per triangle.
const HEAD: usize = 84;
const TRIANGLE: usize = 50;
/// Bytes of the normal before the corners.
const NORMAL: usize = 12;
/// Number of leading bytes without a zero by which a text is recognized.
const LOOK: usize = 512;

/// The corners of the triangles of an STL file, in its order.
///
/// # Errors
/// Fails if the bytes are no complete file of that kind, or if a coordinate is not finite: the error names the line of
/// a text or the byte of a binary file.
pub fn parse(bytes: &[u8]) -> Result<Vec<[Point; 3]>, MeshFileError> {
    let announced = announced(bytes);
    let is_whole = announced.is_some_and(|count| bytes.len() as u64 == HEAD as u64 + count * TRIANGLE as u64);
    let triangles = if !is_whole && is_text(bytes) { text(bytes)? } else { binary(bytes, announced)? };
    if triangles.is_empty() {
        return Err(syntax(FilePosition::Line(1), "no triangle", "at least one"));
    }
    Ok(triangles)
}

fn syntax(at: FilePosition, found: impl Into<String>, expected: &str) -> MeshFileError {
    MeshFileError::Syntax { at, found: found.into(), expected: expected.to_owned() }
}

/// The number of triangles that a binary file announces.
fn announced(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(HEAD - 4..HEAD)?.try_into().ok()?;
    Some(u64::from(u32::from_le_bytes(count)))
}

fn is_text(bytes: &[u8]) -> bool {
    let head = bytes.get(..bytes.len().min(LOOK)).unwrap_or_default();
    let begins = head.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    begins && !head.contains(&0)
}

fn binary(bytes: &[u8], announced: Option<u64>) -> Result<Vec<[Point; 3]>, MeshFileError> {
    let Some(found) = announced else {
        let expected = "a text that begins with `solid`, or a binary file of 84 bytes and 50 per triangle";
        return Err(syntax(FilePosition::Byte(0), format!("a file of {} bytes", bytes.len()), expected));
    };
    let body = bytes.get(HEAD..).unwrap_or_default();
    let room = (body.len() / TRIANGLE) as u64;
    let at = FilePosition::Byte(HEAD - 4);
    if found > room {
        return Err(MeshFileError::Count { at, what: "triangles", found, room });
    }
    let rest = body.len() as u64 - found * TRIANGLE as u64;
    if rest > 0 {
        let expected = "84 bytes and 50 per triangle; write the file anew";
        return Err(syntax(at, format!("{found} triangles and {rest} bytes behind them"), expected));
    }
    let mut triangles = Vec::with_capacity(body.len() / TRIANGLE);
    for (number, triangle) in body.chunks_exact(TRIANGLE).enumerate() {
        let mut corners = [[0.0; 3]; 3];
        let numbers = triangle.iter().skip(NORMAL).copied().collect::<Vec<u8>>();
        for (i, (to, from)) in corners.as_flattened_mut().iter_mut().zip(numbers.chunks_exact(4)).enumerate() {
            let value = f32::from_le_bytes(from.try_into().unwrap_or_default());
            if !value.is_finite() {
                let at = FilePosition::Byte(HEAD + number * TRIANGLE + NORMAL + 4 * i);
                return Err(syntax(at, format!("the coordinate {value}"), "a finite number"));
            }
            *to = f64::from(value);
        }
        triangles.push(corners);
    }
    Ok(triangles)
}

fn text(bytes: &[u8]) -> Result<Vec<[Point; 3]>, MeshFileError> {
    let (mut triangles, mut corners, mut is_open, mut lines) = (Vec::new(), Vec::<Point>::new(), false, 0);
    for (number, line) in bytes.split(|byte| *byte == b'\n').enumerate() {
        let (line, at) = (String::from_utf8_lossy(line), FilePosition::Line(number + 1));
        let mut words = line.split_ascii_whitespace();
        let Some(word) = words.next() else { continue };
        lines = number + 1;
        match word.to_ascii_lowercase().as_str() {
            "solid" => is_open = true,
            "endsolid" => is_open = false,
            "facet" | "outer" | "endfacet" if is_open => {}
            "vertex" if is_open => corners.push(vertex(at, words)?),
            "endloop" if is_open => {
                let found = corners.len();
                let triangle = std::mem::take(&mut corners).try_into();
                let expected = "three: the facets of STL are triangles";
                triangles.push(triangle.map_err(|_| syntax(at, format!("a loop of {found} vertices"), expected))?);
            }
            _ => {
                let shown: String = word.chars().take(20).collect();
                let expected =
                    "`facet`, `outer loop`, `vertex`, `endloop` or `endfacet` between `solid` and `endsolid`";
                return Err(syntax(at, format!("\"{}\"", shown.escape_debug()), expected));
            }
        }
    }
    if is_open || !corners.is_empty() {
        let found = format!("the end of the file after {} triangles", triangles.len());
        return Err(syntax(FilePosition::Line(lines), found, "`endsolid`; the file may be truncated"));
    }
    Ok(triangles)
}

/// The coordinates of a vertex.
fn vertex<'w>(at: FilePosition, words: impl Iterator<Item = &'w str>) -> Result<Point, MeshFileError> {
    let words: Vec<&str> = words.collect();
    let number = |word: &&str| word.parse().ok().filter(|value: &f64| value.is_finite());
    let numbers: Option<Vec<f64>> = words.iter().map(number).collect();
    let shown: String = words.join(" ").chars().take(60).collect();
    let refuse = || syntax(at, format!("`vertex {}`", shown.escape_debug()), "three finite numbers behind `vertex`");
    numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(refuse)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp, reason = "a test fails by panicking, and the numbers are exact")]
mod tests {
    use super::*;

    const CORNERS: [[Point; 3]; 2] =
        [[[0.0, 0.5, -1.25], [1.0, 0.0, 3.0], [2.0, 2.0, 0.0]], [[1e-3, 0.0, 0.0], [0.0, 1e20, 0.0], [0.0, 0.0, -7.0]]];

    fn written(triangles: &[[Point; 3]]) -> Vec<u8> {
        let mut bytes = b"solid of a program that writes such headers".to_vec();
        bytes.resize(80, 0);
        bytes.extend((triangles.len() as u32).to_le_bytes());
        for triangle in triangles {
            bytes.extend([0; 12]);
            bytes.extend(triangle.as_flattened().iter().flat_map(|x| (*x as f32).to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    fn text_of(triangles: &[[Point; 3]]) -> String {
        let facet = |corners: &[Point; 3]| {
            let vertices = corners.map(|[x, y, z]| format!("      vertex {x:e} {y:e} {z:e}\r\n")).concat();
            format!("  facet normal 0 0 0\r\n    outer loop\r\n{vertices}    endloop\r\n  endfacet\r\n")
        };
        format!("solid a punch\r\n{}endsolid a punch\r\n", triangles.iter().map(facet).collect::<String>())
    }

    fn told(bytes: &[u8]) -> String {
        parse(bytes).map_or_else(|error| error.to_string(), |all| format!("{} triangles", all.len()))
    }

    #[test]
    fn both_kinds_have_the_same_triangles() {
        let [text, binary] = [text_of(&CORNERS).into_bytes(), written(&CORNERS)].map(|bytes| parse(&bytes).unwrap());
        assert_eq!(text, CORNERS);
        assert_eq!(binary, CORNERS.map(|corners| corners.map(|x| x.map(|c| f64::from(c as f32)))));
        let capitals = text_of(&CORNERS).to_uppercase();
        assert_eq!(parse(capitals.as_bytes()).unwrap(), CORNERS);
    }

    /// A file truncated at any byte is refused.
    #[test]
    fn no_truncated_file_is_read() {
        for bytes in [text_of(&CORNERS).into_bytes(), written(&CORNERS)] {
            for end in 0..bytes.len() - 12 {
                assert!(parse(&bytes[..end]).is_err(), "{end} of {}", bytes.len());
            }
        }
    }

    #[test]
    fn what_is_said_of_spoiled_files() {
        let binary = written(&CORNERS);
        let mut nan = binary.clone();
        nan[84 + 50 + 12 + 8..84 + 50 + 12 + 12].copy_from_slice(&f32::NAN.to_le_bytes());
        let counted = |count: u32| {
            let mut bytes = binary.clone();
            bytes[80..84].copy_from_slice(&count.to_le_bytes());
            bytes
        };
        let text = text_of(&CORNERS);
        for (bytes, expected) in [
            (nan, "byte 154: found the coordinate NaN, expected a finite number"),
            (
                counted(3),
                "byte 80: found a count of 3 triangles, expected at most the 2 that the rest of the file can hold; it may be truncated",
            ),
            (
                counted(u32::MAX),
                "byte 80: found a count of 4294967295 triangles, expected at most the 2 that the rest of the file can hold; it may be truncated",
            ),
            (
                counted(1),
                "byte 80: found 1 triangles and 50 bytes behind them, expected 84 bytes and 50 per triangle; write the file anew",
            ),
            (written(&[]), "line 1: found no triangle, expected at least one"),
            (
                b"PK".to_vec(),
                "byte 0: found a file of 2 bytes, expected a text that begins with `solid`, or a binary file of 84 bytes and 50 per triangle",
            ),
            (
                text.replacen("1e20", "1e999", 1).into_bytes(),
                "line 12: found `vertex 0e0 1e999 0e0`, expected three finite numbers behind `vertex`",
            ),
            (
                text.replacen("1e0 0e0 3e0", "1e0 0e0", 1).into_bytes(),
                "line 5: found `vertex 1e0 0e0`, expected three finite numbers behind `vertex`",
            ),
            (
                text.replacen("vertex 1e0 0e0 3e0", "", 1).into_bytes(),
                "line 7: found a loop of 2 vertices, expected three: the facets of STL are triangles",
            ),
            (
                text.replacen("endfacet", "endfact", 1).into_bytes(),
                "line 8: found \"endfact\", expected `facet`, `outer loop`, `vertex`, `endloop` or `endfacet` between `solid` and `endsolid`",
            ),
            (
                text.replacen("endsolid a punch", "", 1).into_bytes(),
                "line 15: found the end of the file after 2 triangles, expected `endsolid`; the file may be truncated",
            ),
        ] {
            assert_eq!(told(&bytes), expected);
        }
    }

    /// Randomly changed bytes never crash the program, and all coordinates read are finite.
    #[test]
    fn spoiled_bytes_are_refused_or_read() {
        let mut random = 0x9E37_79B9_7F4A_7C15u64;
        let mut next = || {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            random
        };
        for bytes in [text_of(&CORNERS).into_bytes(), written(&CORNERS)] {
            for _ in 0..20_000 {
                let mut spoiled = bytes.clone();
                for _ in 0..=next() % 3 {
                    let at = next() as usize % spoiled.len();
                    spoiled[at] = next() as u8;
                }
                spoiled.truncate(spoiled.len() - (next() as usize % 4) * (next() as usize % 20));
                if let Ok(triangles) = parse(&spoiled) {
                    assert!(triangles.as_flattened().as_flattened().iter().all(|x| x.is_finite()));
                }
            }
        }
    }
}
