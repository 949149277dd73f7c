package org.fieldwalk

import java.io.File

/** The folder that tests/examples/walk_for_bindings.rs has written; it says what is in it. */
object Walk {
    private val folder = File(System.getProperty("fieldwalk.walk") ?: error("run by: cargo xtask test --only kotlin"))

    val mapFolder = File(folder, "map")
    val records = records("walk")
    val samples = records.filter { it.kind != "waypoint" }
    val waypoints = records.filter { it.kind == "waypoint" }
    val start = waypoints.first()

    val hint = PositionHint(start.point, 2.0, 0, start.timeNs)

    /** The walk as a log of text. */
    val log = File(folder, "walk.txt")

    /** The floor's plan in GeoJSON. */
    val plan = File(folder, "plan.geojson").readBytes()

    /** What `fieldwalk replay --bits` says of the walk. */
    val digest = File(folder, "walk.bits").readText().substringBefore(' ')

    /** Leaves the digest of the walk's fixes as Kotlin found it, for the report of `cargo xtask test`. */
    fun tell(digest: String, nFixes: Int) = File(folder, "kotlin.bits").writeText("$digest $nFixes\n")

    fun records(name: String) = File(folder, "$name.samples").readLines().map { Record(it.split(' ')) }

    fun batch(name: String): ByteArray = File(folder, "$name.batch").readBytes()

    fun openMap(): BuildingMap = BuildingMap.open(mapFolder.path)
}

/** A line of a `.samples` file. */
class Record(private val fields: List<String>) {
    val timeNs = fields[0].toLong()
    val kind = fields[1]

    val point get() = Point2(double(2), double(3))

    /** The same reading at another time. */
    fun at(timeNs: Long) = Record(listOf("$timeNs") + fields.drop(1))

    /** The same reading of a phone that is held otherwise: `turn` takes a vector of its frame to the other's. */
    fun turned(turn: (List<Float>) -> List<Float>): Record {
        val nVectors = mapOf("specific_force" to 1, "angular_rate" to 1, "magnetic_field" to 1, "uncalibrated_magnetic_field" to 2)
        val turned = (0..<(nVectors[kind] ?: return this)).flatMap { k -> turn(List(3) { float(2 + 3 * k + it) }) }
        return Record(fields.take(2) + turned.map { "%08x".format(it.toRawBits()) })
    }

    fun addTo(batch: SampleBatch) = when (kind) {
        "specific_force" -> batch.specificForce(timeNs, float(2), float(3), float(4))
        "angular_rate" -> batch.angularRate(timeNs, float(2), float(3), float(4))
        "magnetic_field" -> batch.magneticField(timeNs, float(2), float(3), float(4))
        "uncalibrated_magnetic_field" ->
            batch.uncalibratedMagneticField(timeNs, float(2), float(3), float(4), float(5), float(6), float(7))
        "pressure" -> batch.pressure(timeNs, float(2))
        "ble_sighting" -> batch.bleSighting(timeNs, float(2), bytes(3))
        "ibeacon_sighting" -> batch.ibeaconSighting(timeNs, float(2), bytes(3), fields[4].toInt(), fields[5].toInt())
        "wifi_sighting" -> batch.wifiSighting(timeNs, float(2), bytes(3))
        "card_frame" -> batch.cardFrame(timeNs, bytes(2))
        else -> error("a record called $kind")
    }

    fun float(k: Int) = Float.fromBits(fields[k].toUInt(16).toInt())
    fun int(k: Int) = fields[k].toInt()
    private fun double(k: Int) = Double.fromBits(fields[k].toULong(16).toLong())
    fun bytes(k: Int) = fields[k].chunked(2).map { it.toInt(16).toByte() }.toByteArray()
}

fun batchOf(records: List<Record>): SampleBatch {
    val batch = SampleBatch()
    records.forEach { it.addTo(batch) }
    return batch
}

/** The bytes from the buffer's position to its limit. */
fun java.nio.ByteBuffer.toByteArray(): ByteArray = ByteArray(remaining()).also { duplicate().get(it) }
