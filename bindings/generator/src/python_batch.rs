//! The Python encoder of sample batches, printed from the layout.

use fieldwalk_batch::layout::{
    Encoding, HEADER_BYTES, MAGIC, N_BYTES_AT, N_RECORDS_AT, RECORDS, RecordLayout, VERSION, VERSION_AT,
};

/// The source of `sample_batch.py`.
pub fn source() -> String {
    let magic = String::from_utf8_lossy(&MAGIC);
    let packers: String = RECORDS.iter().map(packer).collect();
    let methods: String = RECORDS.iter().map(method).collect();
    let layouts: String = RECORDS.iter().map(layout).collect();
    format!(
        r#""""Sensor samples packed for the engine: one call carries many.

Generated from bindings/batch/src/layout.rs; do not edit.
"""

from __future__ import annotations

import struct

__all__ = ["RECORDS", "SampleBatch"]

_HEADER = struct.Struct("<4sHII")
assert _HEADER.size == {HEADER_BYTES}, "magic, version at {VERSION_AT}, records at {N_RECORDS_AT}, bytes at {N_BYTES_AT}"

{packers}
#: Per code, a record's name, its whole length in bytes, and its fields as numpy names types, the first at byte 2.
RECORDS: dict[int, tuple[str, int, list[tuple[str, str]]]] = {{
{layouts}}}


class SampleBatch:
    """Sensor samples, packed for ``Positioner.push_samples`` and its kin.

    Times are in nanoseconds on one clock for all sensors. Vectors are in the device frame, which is Android's: x to
    the right of the screen, y to its top, z out of it. Numbers are rounded to 32 bits; one that does not fit raises
    ``OverflowError``. Not for two threads at once.
    """

    __slots__ = ("_records", "_size")

    def __init__(self) -> None:
        self._records = bytearray()
        self._size = 0

    def __len__(self) -> int:
        """Number of samples since the last ``clear``."""
        return self._size

    def clear(self) -> None:
        """Forgets all samples."""
        self._records.clear()
        self._size = 0

    def to_bytes(self) -> bytes:
        """The batch so far."""
        n_bytes = _HEADER.size + len(self._records)
        return _HEADER.pack(b"{magic}", {VERSION}, self._size, n_bytes) + self._records
{methods}

def _checked(name: str, value: bytes, n_bytes: int) -> bytes:
    if len(value) != n_bytes:
        raise ValueError(f"{{name}} is {{len(value)}} bytes long, not {{n_bytes}}")
    return bytes(value)


def _u16(name: str, value: int) -> int:
    if not 0 <= value <= 0xFFFF:
        raise ValueError(f"{{name}} is not from 0 to 65535")
    return value
"#
    )
}

/// How a record is packed: code, length, time, and its fields.
fn packer(record: &RecordLayout) -> String {
    let fields: String = record.fields.iter().map(|field| format_of(field.encoding)).collect();
    format!("_{} = struct.Struct(\"<BBq{fields}\")\n", record.name.to_uppercase())
}

fn format_of(encoding: Encoding) -> String {
    match encoding {
        Encoding::F32 => "f".to_owned(),
        Encoding::U16 => "H".to_owned(),
        Encoding::Bytes(n) => format!("{n}s"),
    }
}

/// The row of a record in the table for decoders.
fn layout(record: &RecordLayout) -> String {
    let mut row =
        format!("    {}: (\"{}\", {}, [(\"time_ns\", \"<i8\")", record.code, record.name, record.n_bytes());
    for field in record.fields {
        let kind = match field.encoding {
            Encoding::F32 => "<f4".to_owned(),
            Encoding::U16 => "<u2".to_owned(),
            Encoding::Bytes(n) => format!("V{n}"),
        };
        row += &format!(", (\"{}\", \"{kind}\")", field.name);
    }
    row + "]),\n"
}

/// The method that adds a record.
fn method(record: &RecordLayout) -> String {
    let RecordLayout { code, name, purpose, fields } = record;
    let (mut parameters, mut values, mut documentation) = (String::new(), String::new(), String::new());
    for field in *fields {
        let field_name = field.name;
        let (kind, value) = match field.encoding {
            Encoding::F32 => ("float", field_name.to_owned()),
            Encoding::U16 => ("int", format!("_u16(\"{field_name}\", {field_name})")),
            Encoding::Bytes(n) => ("bytes", format!("_checked(\"{field_name}\", {field_name}, {n})")),
        };
        parameters += &format!(", {field_name}: {kind}");
        values += &format!(", {value}");
        documentation += &format!("        :param {field_name}: {}\n", field.purpose);
    }
    let (n_bytes, packer) = (record.n_bytes(), name.to_uppercase());
    format!(
        r#"
    def {name}(self, time_ns: int{parameters}) -> None:
        """{purpose}

        :param time_ns: When.
{documentation}        """
        self._records += _{packer}.pack({code}, {n_bytes}, time_ns{values})
        self._size += 1
"#
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_method_takes_the_fields_and_packs_them_in_order() {
        let source = source();
        assert!(source.contains("_IBEACON_SIGHTING = struct.Struct(\"<BBqf16sHH\")\n"), "{source}");
        let head = "    def ibeacon_sighting(self, time_ns: int, rssi_dbm: float, uuid: bytes, major: int, minor: int) -> None:\n";
        let (_, body) = source.split_once(head).expect("the method of iBeacons");
        let pack = "_IBEACON_SIGHTING.pack(7, 34, time_ns, rssi_dbm, _checked(\"uuid\", uuid, 16), \
                    _u16(\"major\", major), _u16(\"minor\", minor))";
        assert!(body.contains(pack), "{body}");
        let row = "    5: (\"pressure\", 14, [(\"time_ns\", \"<i8\"), (\"pressure_hpa\", \"<f4\")]),\n";
        assert!(source.contains(row), "{source}");
    }

    #[test]
    fn the_name_of_every_record_is_a_method() {
        let source = source();
        for record in &RECORDS {
            assert!(source.contains(&format!("    def {}(self", record.name)), "{}", record.name);
        }
    }
}
