//! The Kotlin encoder of sample batches, printed from the layout.

use fieldwalk_batch::layout::{
    Encoding, HEADER_BYTES, MAGIC, N_BYTES_AT, N_RECORDS_AT, RECORDS, RecordLayout, VERSION, VERSION_AT,
};

use crate::wording::{camel_case, in_a_list};

/// The source of `SampleBatch.kt`.
pub fn source() -> String {
    let magic = u32::from_le_bytes(MAGIC);
    let methods: String = RECORDS.iter().map(method).collect();
    format!(
        r#"// Generated from bindings/batch/src/layout.rs; do not edit.
package org.fieldwalk

import java.nio.ByteBuffer
import java.nio.ByteOrder

/**
 * Sensor samples packed for [Positioner.pushSamples]: one call carries many.
 *
 * Add samples as they come, push [bytes], [clear], go on with the same object: it keeps its memory, so that the sensor
 * loop makes no garbage of its own. It grows as needed. Not for two threads at once.
 *
 * Times are in nanoseconds on one clock for all sensors, such as Android's `SensorEvent.timestamp`. Vectors are in the
 * device frame, which is Android's: x to the right of the screen, y to its top, z out of it.
 *
 * @param capacityBytes memory to begin with
 */
public class SampleBatch(capacityBytes: Int = 4096) {{
    private var buffer: ByteBuffer = allocated(maxOf(capacityBytes, HEADER_BYTES))

    /** Number of samples since the last [clear]. */
    public var size: Int = 0
        private set

    /** Forgets all samples. */
    public fun clear() {{
        buffer.position(HEADER_BYTES)
        size = 0
    }}

    /** The batch so far: a view that the next sample or [clear] makes invalid. */
    public fun bytes(): ByteBuffer {{
        val view = written().duplicate()
        view.flip()
        return view
    }}

    /** The batch so far, up to the buffer's position. */
    internal fun written(): ByteBuffer {{
        buffer.putInt({N_RECORDS_AT}, size)
        buffer.putInt({N_BYTES_AT}, buffer.position())
        return buffer
    }}
{methods}
    /** Room for a record, and its header. */
    private fun begin(code: Int, nBytes: Int, timeNs: Long): ByteBuffer {{
        if (buffer.remaining() < nBytes) {{
            val larger = allocated(Math.multiplyExact(buffer.capacity(), 2) + nBytes)
            buffer.flip()
            buffer.position(HEADER_BYTES)
            larger.put(buffer)
            buffer = larger
        }}
        size += 1
        return buffer.put(code.toByte()).put(nBytes.toByte()).putLong(timeNs)
    }}

    private companion object {{
        const val HEADER_BYTES: Int = {HEADER_BYTES}

        /** An empty batch. */
        fun allocated(nBytes: Int): ByteBuffer {{
            val buffer = ByteBuffer.allocateDirect(nBytes).order(ByteOrder.LITTLE_ENDIAN)
            buffer.putInt(0, 0x{magic:08x})
            buffer.putShort({VERSION_AT}, {VERSION})
            buffer.position(HEADER_BYTES)
            return buffer
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
        format!("    /**\n     * {}\n     *\n     * @param timeNs when\n", record.purpose);
    let (mut parameters, mut checks, mut puts) = (String::new(), String::new(), String::new());
    for field in record.fields {
        let field_name = camel_case(field.name);
        let (kind, check, put) = match field.encoding {
            Encoding::F32 => ("Float", None, format!("putFloat({field_name})")),
            Encoding::U16 => (
                "Int",
                Some(format!(
                    "require({field_name} in 0..0xffff) {{ \"{field_name} is not from 0 to 65535\" }}"
                )),
                format!("putShort({field_name}.toShort())"),
            ),
            Encoding::Bytes(n) => (
                "ByteArray",
                Some(format!(
                    "require({field_name}.size == {n}) {{ \"{field_name} is not {n} bytes long\" }}"
                )),
                format!("put({field_name})"),
            ),
        };
        documentation += &format!("     * @param {field_name} {}\n", in_a_list(field.purpose));
        parameters += &format!(", {field_name}: {kind}");
        checks.extend(check.map(|check| format!("        {check}\n")));
        puts += &format!("\n            .{put}");
    }
    documentation += "     */\n";
    let (code, n_bytes) = (record.code, record.n_bytes());
    format!(
        "\n{documentation}    public fun {name}(timeNs: Long{parameters}) {{\n{checks}        \
         begin({code}, {n_bytes}, timeNs){puts}\n    }}\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_method_takes_the_fields_and_writes_them_in_order() {
        let source = source();
        let method = "    public fun ibeaconSighting(timeNs: Long, rssiDbm: Float, uuid: ByteArray, major: Int, minor: Int) {\n";
        let (_, body) = source.split_once(method).expect("the method of iBeacons");
        let calls: Vec<&str> =
            body.lines().take_while(|line| *line != "    }").map(str::trim).skip(3).collect();
        assert_eq!(
            calls,
            [
                "begin(7, 34, timeNs)",
                ".putFloat(rssiDbm)",
                ".put(uuid)",
                ".putShort(major.toShort())",
                ".putShort(minor.toShort())"
            ]
        );
    }

    #[test]
    fn the_name_of_every_record_is_a_method() {
        let source = source();
        for record in &RECORDS {
            assert!(source.contains(&format!("fun {}(", camel_case(record.name))), "{}", record.name);
        }
    }
}
