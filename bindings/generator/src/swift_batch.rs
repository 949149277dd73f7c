//! The Swift encoder of sample batches, printed from the layout.

use fieldwalk_batch::layout::{
    Encoding, HEADER_BYTES, MAGIC, N_BYTES_AT, N_RECORDS_AT, RECORDS, RecordLayout, VERSION, VERSION_AT,
};

use crate::wording::{camel_case, in_a_list};

/// The source of `SampleBatch.swift`.
pub fn source() -> String {
    let magic = MAGIC.map(|byte| format!("0x{byte:02x}")).join(", ");
    let methods: String = RECORDS.iter().map(method).collect();
    format!(
        r#"// Generated from bindings/batch/src/layout.rs; do not edit.
import Foundation

/// Sensor samples packed for ``Positioner/pushSamples(batch:)``: one call carries many.
///
/// Add samples as they come, push ``bytes``, ``removeAll()``, go on with the same value: it keeps its memory. It grows as
/// needed. Times are in nanoseconds on one clock for all sensors; on Apple's platforms that is the time since boot, as
/// ``SensorClock`` has it. Vectors are in the device frame: x to the right of the screen, y to its top, z out of it.
public struct SampleBatch: Sendable, Equatable {{
    private var storage: [UInt8]

    /// Number of samples since the last ``removeAll()``.
    public private(set) var count: Int = 0

    /// An empty batch.
    ///
    /// - Parameter capacityBytes: memory to begin with
    public init(capacityBytes: Int = 4096) {{
        storage = [{magic}]
        storage.reserveCapacity(max(capacityBytes, {HEADER_BYTES}))
        storage.append(contentsOf: repeatElement(0, count: {HEADER_BYTES} - storage.count))
        set(UInt16({VERSION}), at: {VERSION_AT})
        set(UInt32({HEADER_BYTES}), at: {N_BYTES_AT})
    }}

    /// Forgets all samples.
    public mutating func removeAll() {{
        storage.removeSubrange({HEADER_BYTES}...)
        count = 0
        finishHeader()
    }}

    /// The batch so far.
    public var bytes: Data {{ Data(storage) }}
{methods}
    /// A value that a record cannot hold; nothing is added then.
    public enum Refusal: Error, Equatable, Sendable {{
        /// The field is not so many bytes long.
        case wrongLength(field: String, expectedBytes: Int)
    }}

    private mutating func begin(_ code: UInt8, _ nBytes: UInt8, _ timeNs: Int64) {{
        storage.append(code)
        storage.append(nBytes)
        append(UInt64(bitPattern: timeNs))
        count += 1
    }}

    private mutating func append<Number: FixedWidthInteger>(_ number: Number) {{
        withUnsafeBytes(of: number.littleEndian) {{ storage.append(contentsOf: $0) }}
    }}

    private mutating func finishHeader() {{
        set(UInt32(count), at: {N_RECORDS_AT})
        set(UInt32(storage.count), at: {N_BYTES_AT})
    }}

    private mutating func set<Number: FixedWidthInteger>(_ number: Number, at position: Int) {{
        withUnsafeBytes(of: number.littleEndian) {{ bytes in
            storage.replaceSubrange(position..<position + bytes.count, with: bytes)
        }}
    }}
}}
"#
    )
}

/// The method that adds a record.
fn method(record: &RecordLayout) -> String {
    let name = camel_case(record.name);
    let mut documentation =
        format!("    /// {}\n    ///\n    /// - Parameters:\n    ///   - timeNs: when\n", record.purpose);
    let (mut parameters, mut checks, mut puts) = (String::new(), String::new(), String::new());
    for field in record.fields {
        let field_name = camel_case(field.name);
        let (kind, put) = match field.encoding {
            Encoding::F32 => ("Float", format!("append({field_name}.bitPattern)")),
            Encoding::U16 => ("UInt16", format!("append({field_name})")),
            Encoding::Bytes(n) => {
                let refusal = format!("Refusal.wrongLength(field: \"{field_name}\", expectedBytes: {n})");
                checks += &format!("        guard {field_name}.count == {n} else {{ throw {refusal} }}\n");
                ("some Collection<UInt8>", format!("storage.append(contentsOf: {field_name})"))
            }
        };
        documentation += &format!("    ///   - {field_name}: {}\n", in_a_list(field.purpose));
        parameters += &format!(", {field_name}: {kind}");
        puts += &format!("        {put}\n");
    }
    let throws = if checks.is_empty() {
        ""
    } else {
        documentation += "    /// - Throws: ``Refusal`` when an identity has another length.\n";
        " throws"
    };
    let (code, n_bytes) = (record.code, record.n_bytes());
    format!(
        "\n{documentation}    public mutating func {name}(timeNs: Int64{parameters}){throws} {{\n{checks}        \
         begin({code}, {n_bytes}, timeNs)\n{puts}        finishHeader()\n    }}\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_method_takes_the_fields_checks_lengths_and_writes_in_order() {
        let source = source();
        let method = "    public mutating func ibeaconSighting(timeNs: Int64, rssiDbm: Float, \
                      uuid: some Collection<UInt8>, major: UInt16, minor: UInt16) throws {\n";
        let (_, body) = source.split_once(method).expect("the method of iBeacons");
        let calls: Vec<&str> = body.lines().take_while(|line| *line != "    }").map(str::trim).collect();
        assert_eq!(
            calls,
            [
                "guard uuid.count == 16 else { throw Refusal.wrongLength(field: \"uuid\", expectedBytes: 16) }",
                "begin(7, 34, timeNs)",
                "append(rssiDbm.bitPattern)",
                "storage.append(contentsOf: uuid)",
                "append(major)",
                "append(minor)",
                "finishHeader()"
            ]
        );
    }

    #[test]
    fn the_name_of_every_record_is_a_method() {
        let source = source();
        for record in &RECORDS {
            assert!(source.contains(&format!("func {}(", camel_case(record.name))), "{}", record.name);
        }
    }
}
