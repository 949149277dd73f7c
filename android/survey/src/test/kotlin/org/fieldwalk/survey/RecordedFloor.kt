package org.fieldwalk.survey

import org.fieldwalk.Record
import org.fieldwalk.RecordingReader
import org.fieldwalk.Waypoint
import java.io.File
import java.nio.ByteBuffer
import java.nio.ByteOrder

/** The simulated floor that `cargo xtask android` has made with `fieldwalk simulate`, and what the host says of its survey. */
object RecordedFloor {
    private val folder = File(System.getProperty("fieldwalk.floor") ?: error("run by: cargo xtask android"))

    val plan: ByteArray get() = File(folder, "plan.geojson").readBytes()
    /** Without those that stand in a room for fingerprints: a survey lives on lines between waypoints. */
    val surveyWalks: List<File> by lazy { recordings("survey").filter { nWaypoints(it) > 1 } }
    val testWalk: File get() = recordings("test").first()

    /** The map that `fieldwalk survey` builds of the same walks, and the errors that it expects, in metres. */
    val hostMap: File get() = File("${folder.path}.map")
    val expectedMedianM: Double get() = expected("median_m")
    val expectedP80M: Double get() = expected("p80_m")

    private fun recordings(name: String) =
        File(folder, name).listFiles { file -> file.extension == "mcap" }!!.sortedBy { it.name }

    private fun nWaypoints(recording: File) = RecordingReader.open(recording.path).use { reader ->
        generateSequence { reader.nextPart(UInt.MAX_VALUE) }.count { it.waypoint != null }
    }

    private fun expected(name: String): Double {
        val json = File("${folder.path}.json").readText().substringAfter("\"expected_accuracy\":")
        return Regex("\"$name\":([0-9.]+)").find(json)!!.groupValues[1].toDouble()
    }
}

/** What a recording holds, in order, moved so that it begins at [startNs]. */
fun records(recording: File, startNs: Long, take: (Record?, Waypoint?) -> Unit) = RecordingReader.open(recording.path).use { reader ->
    var offsetNs: Long? = null
    for (part in generateSequence { reader.nextPart(10_000u) }) {
        for (record in samples(part.samples)) {
            // Whole milliseconds, as Android's test clock counts.
            val offset = offsetNs ?: ((startNs - record.timeNs) / 1_000_000 * 1_000_000).also { offsetNs = it }
            take(record.at(record.timeNs + offset), null)
        }
        part.waypoint?.let { take(null, Waypoint(it.timeNs + (offsetNs ?: 0), it.point)) }
    }
}

/** The records of a packed batch, as BATCH.md describes it. */
private fun samples(batch: ByteArray): List<Record> {
    val bytes = ByteBuffer.wrap(batch).order(ByteOrder.LITTLE_ENDIAN)
    bytes.position(HEADER_BYTES)
    return buildList {
        while (bytes.hasRemaining()) {
            val at = bytes.position()
            val (code, nBytes) = bytes.get(at).toInt() to (bytes.get(at + 1).toInt() and 0xff)
            val (name, nFloats) = KINDS.getValue(code)
            val floats = (0..<nFloats).map { "%08x".format(bytes.getInt(at + 10 + 4 * it)) }
            val rest = batch.sliceArray(at + 10 + 4 * nFloats..<at + nBytes).joinToString("") { "%02x".format(it) }
            add(Record(listOf("${bytes.getLong(at + 2)}", name) + floats + listOf(rest).filter { it.isNotEmpty() }))
            bytes.position(at + nBytes)
        }
    }
}

private const val HEADER_BYTES = 14
private val KINDS = mapOf(
    1 to ("specific_force" to 3), 2 to ("angular_rate" to 3), 3 to ("magnetic_field" to 3),
    4 to ("uncalibrated_magnetic_field" to 6), 5 to ("pressure" to 1), 6 to ("ble_sighting" to 1),
    8 to ("wifi_sighting" to 1),
)
