//! The part of MATLAB's level 5 MAT-files that motion capture writes: structures of arrays, little-endian, not
//! compressed. Views over the file's bytes; nothing is allocated.

/// An array: numbers, or a structure whose fields are arrays.
#[derive(Clone, Copy, Debug)]
pub(super) struct Matrix<'a> {
    class: u8,
    /// Rows, columns and pages; further dimensions are refused.
    pub(super) dimensions: [usize; 3],
    /// What follows the name.
    body: &'a [u8],
}

/// Why the bytes are not understood.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mat5Fault {
    NotMat5,
    Compressed,
    Torn,
    NoStructure,
}

const HEADER_BYTES: usize = 128;
const CLASS_STRUCTURE: u8 = 2;
const TYPE_MATRIX: u32 = 14;
const TYPE_COMPRESSED: u32 = 15;

/// The first variable of a file that is a structure.
pub(super) fn first_structure(file: &[u8]) -> Result<Matrix<'_>, Mat5Fault> {
    // The version, 0x0100, and "MI" as a little-endian machine writes it.
    if file.get(124..HEADER_BYTES) != Some(&[0x00, 0x01, b'I', b'M']) {
        return Err(Mat5Fault::NotMat5);
    }
    let mut rest = &file[HEADER_BYTES..];
    while !rest.is_empty() {
        let element = take_element(&mut rest).ok_or(Mat5Fault::Torn)?;
        if element.kind == TYPE_COMPRESSED {
            return Err(Mat5Fault::Compressed);
        }
        match Matrix::parse(element) {
            Some(matrix) if matrix.class == CLASS_STRUCTURE => return Ok(matrix),
            _ => {}
        }
    }
    Err(Mat5Fault::NoStructure)
}

impl<'a> Matrix<'a> {
    fn parse(element: Element<'a>) -> Option<Self> {
        if element.kind != TYPE_MATRIX {
            return None;
        }
        let mut body = element.bytes;
        let flags = take_element(&mut body)?;
        let class = *flags.bytes.first()?;
        let mut dimensions = [1; 3];
        let sizes = take_element(&mut body)?.bytes;
        if sizes.len() / 4 > dimensions.len() {
            return None;
        }
        for (dimension, size) in dimensions.iter_mut().zip(sizes.chunks_exact(4)) {
            *dimension = usize::try_from(i32_of(size)?).ok()?;
        }
        let _name = take_element(&mut body)?;
        Some(Self { class, dimensions, body })
    }

    /// The field called `name` of a structure; of an array of structures, the first one's.
    pub(super) fn field(&self, name: &str) -> Option<Self> {
        if self.class != CLASS_STRUCTURE {
            return None;
        }
        let mut rest = self.body;
        let name_bytes = usize::try_from(i32_of(take_element(&mut rest)?.bytes)?).ok()?;
        if name_bytes == 0 {
            return None;
        }
        let names = take_element(&mut rest)?.bytes;
        for field in names.chunks_exact(name_bytes) {
            let element = take_element(&mut rest)?;
            let length = field.iter().position(|&byte| byte == 0).unwrap_or(name_bytes);
            if &field[..length] == name.as_bytes() {
                return Self::parse(element);
            }
        }
        None
    }

    /// The numbers, columns first; nothing where they are not all there or not doubles.
    pub(super) fn doubles(&self) -> Option<impl ExactSizeIterator<Item = f64> + Clone + 'a> {
        const TYPE_DOUBLE: u32 = 9;
        let numbers = take_element(&mut { self.body })?;
        let n = self.dimensions.iter().try_fold(1usize, |n, &size| n.checked_mul(size))?;
        if numbers.kind != TYPE_DOUBLE || numbers.bytes.len() != n.checked_mul(8)? {
            return None;
        }
        Some(
            numbers
                .bytes
                .chunks_exact(8)
                .map(|b| f64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]])),
        )
    }

    /// The one number of a 1 × 1 array of doubles.
    pub(super) fn number(&self) -> Option<f64> {
        self.doubles()?.next()
    }
}

/// A tagged run of bytes.
#[derive(Clone, Copy)]
struct Element<'a> {
    kind: u32,
    bytes: &'a [u8],
}

/// Takes the first element off `rest`, with the padding to eight bytes.
fn take_element<'a>(rest: &mut &'a [u8]) -> Option<Element<'a>> {
    let tag = u32_of(rest.get(..4)?)?;
    let small_length = (tag >> 16) as usize;
    if small_length > 0 {
        let element = Element { kind: tag & 0xffff, bytes: rest.get(4..8)?.get(..small_length)? };
        *rest = &rest[8..];
        return Some(element);
    }
    let length = u32_of(rest.get(4..8)?)? as usize;
    let bytes = rest.get(8..)?.get(..length)?;
    // The last element of a file may end without its padding.
    let next = (8 + length.next_multiple_of(8)).min(rest.len());
    *rest = &rest[next..];
    Some(Element { kind: tag, bytes })
}

fn u32_of(bytes: &[u8]) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(..4)?.try_into().ok()?))
}

fn i32_of(bytes: &[u8]) -> Option<i32> {
    Some(i32::from_le_bytes(bytes.get(..4)?.try_into().ok()?))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Files and arrays, written byte by byte.
    pub(crate) mod write {
        fn element(kind: u32, bytes: &[u8]) -> Vec<u8> {
            let mut out = [kind.to_le_bytes(), (bytes.len() as u32).to_le_bytes()].concat();
            out.extend(bytes);
            out.resize(out.len().next_multiple_of(8), 0);
            out
        }

        fn matrix(class: u8, dimensions: &[i32], name: &str, body: &[u8]) -> Vec<u8> {
            let sizes: Vec<u8> = dimensions.iter().flat_map(|size| size.to_le_bytes()).collect();
            let parts = [
                element(6, &[class, 0, 0, 0, 0, 0, 0, 0]),
                element(5, &sizes),
                element(1, name.as_bytes()),
                body.to_vec(),
            ];
            element(14, &parts.concat())
        }

        pub(crate) fn doubles(dimensions: &[i32], values: &[f64]) -> Vec<u8> {
            let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
            matrix(6, dimensions, "", &element(9, &bytes))
        }

        pub(crate) fn structure(name: &str, fields: &[(&str, Vec<u8>)]) -> Vec<u8> {
            let names: Vec<u8> =
                fields.iter().flat_map(|(name, _)| format!("{name:\0<32}").into_bytes()).collect();
            // The names' length as a small element: kind 5, four bytes, 32.
            let mut body = vec![5, 0, 4, 0, 32, 0, 0, 0];
            body.extend(element(1, &names));
            body.extend(fields.iter().flat_map(|(_, value)| value.clone()));
            matrix(2, &[1, 1], name, &body)
        }

        pub(crate) fn file(variables: &[Vec<u8>]) -> Vec<u8> {
            let mut out = b"written by hand".to_vec();
            out.resize(124, b' ');
            out.extend([0x00, 0x01, b'I', b'M']);
            out.extend(variables.concat());
            out
        }
    }

    #[test]
    fn fields_of_fields_are_found() {
        let inner = write::structure("", &[("Pi", write::doubles(&[1, 1], &[3.25]))]);
        let outer = write::structure(
            "outer",
            &[("Pages", write::doubles(&[1, 2, 2], &[1.0, 2.0, 3.0, 4.0])), ("Inner", inner)],
        );
        let file = write::file(&[write::doubles(&[1, 1], &[7.0]), outer]);
        let outer = first_structure(&file).unwrap();
        assert_eq!(outer.field("Inner").unwrap().field("Pi").unwrap().number(), Some(3.25));
        let pages = outer.field("Pages").unwrap();
        assert_eq!(pages.dimensions, [1, 2, 2]);
        assert_eq!(pages.doubles().unwrap().collect::<Vec<_>>(), [1.0, 2.0, 3.0, 4.0]);
        assert!(outer.field("Page").is_none() && outer.field("Pages").unwrap().field("Pi").is_none());
    }

    #[test]
    fn what_is_no_such_file_is_told_apart() {
        assert_eq!(first_structure(b"PK").unwrap_err(), Mat5Fault::NotMat5);
        assert_eq!(first_structure(&write::file(&[])).unwrap_err(), Mat5Fault::NoStructure);
        let compressed = [15u32.to_le_bytes(), 0u32.to_le_bytes()].concat();
        assert_eq!(first_structure(&write::file(&[compressed])).unwrap_err(), Mat5Fault::Compressed);
        let whole = write::file(&[write::structure("s", &[("x", write::doubles(&[1, 1], &[1.0]))])]);
        assert_eq!(first_structure(&whole[..whole.len() - 9]).unwrap_err(), Mat5Fault::Torn);
    }

    #[test]
    fn an_array_that_says_it_is_larger_than_it_is_gives_nothing() {
        let lying = write::structure("s", &[("x", write::doubles(&[1, 1_000_000, 1_000_000], &[1.0]))]);
        let file = write::file(&[lying]);
        assert!(first_structure(&file).unwrap().field("x").unwrap().doubles().is_none());
    }
}
