package org.fieldwalk

import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertFalse
import org.junit.jupiter.api.Assertions.assertNotNull
import org.junit.jupiter.api.Assertions.assertNull
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.junit.jupiter.api.io.TempDir
import java.io.File
import java.nio.ByteBuffer

/** What is not as it should be is an exception of the right class or a count, and changes nothing. */
class RefusalTest {
    private val start = Walk.records.first { it.kind == "waypoint" }

    private inline fun <reified E : ApiException> refused(noinline call: () -> Unit): E =
        assertThrows(E::class.java) { call() }

    private fun <R> placed(body: (Positioner) -> R): R = Walk.openMap().use { map ->
        Positioner(map, 0).use { positioner ->
            positioner.hint(PositionHint(start.point, 2.0, 0, start.timeNs))
            body(positioner)
        }
    }

    @Test
    fun `a map that is missing, cut, changed or none is told apart`(@TempDir folder: File) {
        val secret = File(folder, "who-lives-here")
        val missing = refused<ApiException.MapNotFound> { BuildingMap.open(secret.path) }
        assertTrue(missing.remedy.isNotEmpty() && missing.explanation.isNotEmpty())
        assertFalse(missing.message.contains("who-lives-here"), missing.message)

        Walk.mapFolder.copyRecursively(secret)
        val floor = secret.listFiles { file -> file.extension == "safetensors" }!!.single()
        val bytes = floor.readBytes()
        floor.writeBytes(bytes.also { it[it.size - 1] = (it[it.size - 1] + 1).toByte() })
        refused<ApiException.MapCorrupt> { BuildingMap.open(secret.path) }
        refused<ApiException.MapCorrupt> { BuildingMap.fromFloorFiles("office", listOf(bytes)) }
        refused<ApiException.MapMalformed> { BuildingMap.fromFloorFiles("office", listOf(ByteArray(100))) }
        File(secret, "building.json").writeText("{}")
        refused<ApiException.MapMalformed> { BuildingMap.open(secret.path) }
    }

    @Test
    fun `a map as one file that is cut or changed is refused`() {
        val file = Walk.openMap().use { it.export() }
        for (length in listOf(0, 100, file.size / 2, file.size - 1_500)) {
            refused<ApiException.MapMalformed> { BuildingMap.fromFile(file.copyOf(length).toDirect()).close() }
        }
        val changed = file.clone().also { it[file.size / 2] = (it[file.size / 2] + 1).toByte() }
        refused<ApiException.MapCorrupt> { BuildingMap.fromFile(changed.toDirect()).close() }
    }

    @Test
    fun `a recording that is missing, none, of another floor or changed is told apart`(@TempDir folder: File) {
        refused<ApiException.RecordingNotFound> { RecordingReader.open(File(folder, "none").path).close() }
        val file = File(folder, "walk.mcap")
        file.writeBytes(ByteArray(50))
        // Which format it is of shows as its first part is read.
        RecordingReader.open(file.path).use { refused<ApiException.RecordingMalformed> { it.nextPart(1u) } }
        val upstairs = File(folder, "upstairs.mcap")
        Recorder(upstairs.path, RecordingDetails(floor = "F3")).use {
            it.pushSamples(batchOf(Walk.samples).bytes())
            it.finish()
        }
        Surveyor(Walk.plan.toDirect(), "F1", 0).use { surveyor ->
            refused<ApiException.WrongFloor> { surveyor.addRecording(upstairs.path, "w") }
        }
        val bytes = upstairs.readBytes()
        val middle = bytes.size / 2
        val changed = File(folder, "changed.mcap").also { it.writeBytes(bytes.clone().apply { this[middle] = (this[middle] + 1).toByte() }) }
        RecordingReader.open(changed.path).use { reader ->
            val nSamples = generateSequence { reader.nextPart(1_000u) }.sumOf { it.nSamples }
            assertTrue(nSamples < Walk.samples.size.toUInt() && reader.losses().nCorruptChunks >= 1uL, "${reader.losses()}")
        }
    }

    @Test
    fun `a floor or system that is not there is refused`() {
        Walk.openMap().use { map ->
            refused<ApiException.UnknownFloor> { Positioner(map, 7).close() }
            refused<ApiException.UnknownSystem> { Positioner(map, 0, PositionerOptions(system = "oracle")).close() }
        }
        assertTrue(systems().contains("fused"))
        assertTrue(version().matches(Regex("""\d+\.\d+\.\d+.*""")), version())
    }

    @Test
    fun `a hint of another floor or off the plan is refused and changes nothing`() = placed { positioner ->
        val before = positioner.fix()
        assertNotNull(before)
        refused<ApiException.WrongFloor> { positioner.hint(PositionHint(Point2(1.0, 1.0), 2.0, 3, 0)) }
        val off = refused<ApiException.BadHint> {
            positioner.hint(PositionHint(Point2(48123.5, 1.0), 2.0, 0, 0))
        }
        assertFalse(off.message.contains("48123"), off.message)
        refused<ApiException.BadHint> { positioner.hint(PositionHint(Point2(Double.NaN, 1.0), 2.0, 0, 0)) }
        assertEquals(before, positioner.fix())
    }

    @Test
    fun `a torn or foreign batch is refused whole`() = placed { positioner ->
        val batch = batchOf(Walk.samples.take(500)).bytes().toByteArray()
        refused<ApiException.BatchTorn> { positioner.pushSamples(batch.copyOf(batch.size - 5).toDirect()) }
        refused<ApiException.BatchMalformed> { positioner.pushSamples(ByteArray(40).toDirect()) }
        refused<ApiException.BatchMalformed> { positioner.pushSamples(ByteBuffer.allocateDirect(0)) }
        val newer = batch.clone().also { it[4] = 9 }
        refused<ApiException.BatchTooNew> { positioner.pushSamples(newer.toDirect()) }
        val status = positioner.status()
        assertEquals(Rejections(0u, 0u, 0u, 0u) to BatchFaults(0u, 0u), status.rejections to status.batchFaults)
        assertEquals(listOf(MissingInput.SAMPLES), status.missing.map { it.what })
    }

    @Test
    fun `bad records and samples are counted and cost no other`() {
        val good = placed { it.pushSamples(batchOf(Walk.samples).bytes()) }
        placed { positioner ->
            val damaged = batchOf(Walk.samples)
            damaged.specificForce(Walk.samples.last().timeNs + 1, Float.NaN, 0f, 0f)
            damaged.pressure(Walk.samples.last().timeNs + 2, 1000f)
            val bytes = damaged.bytes().toByteArray()
            bytes[bytes.size - 14] = 99
            assertEquals(good, positioner.pushSamples(bytes.toDirect()))
            assertEquals(1uL, positioner.status().rejections.implausible)
            assertEquals(BatchFaults(unknownKind = 1u, malformed = 0u), positioner.status().batchFaults)
        }
    }

    @Test
    fun `the past and the time before a start give no fix`() {
        Walk.openMap().use { map ->
            Positioner(map, 0).use { positioner ->
                assertNull(positioner.fix())
                assertNull(positioner.fixAt(5))
                val missing = positioner.status().missing.first()
                assertEquals(MissingInput.START, missing.what)
                assertTrue("hint" in missing.remedy, missing.remedy)
            }
        }
        placed { positioner ->
            positioner.pushSamples(batchOf(Walk.samples).bytes())
            refused<ApiException.TimeInPast> { positioner.fixAt(start.timeNs - 1) }
            assertEquals(emptyList<Missing>(), positioner.status().missing)
        }
    }

    @Test
    fun `a snapshot that is torn or of another seed is refused and changes nothing`() = placed { positioner ->
        val snapshot = positioner.snapshot()
        val before = positioner.fix()
        for (length in listOf(0, 3, 20, snapshot.size - 1)) {
            refused<ApiException.SnapshotMalformed> { positioner.restore(snapshot.copyOf(length).toDirect()) }
        }
        Walk.openMap().use { map ->
            Positioner(map, 0, PositionerOptions(seed = 5uL)).use { other ->
                refused<ApiException.SnapshotForeign> { positioner.restore(other.snapshot().toDirect()) }
            }
        }
        assertEquals(before, positioner.fix())
    }

    @Test
    fun `the encoder refuses identities of a wrong length and numbers out of range`() {
        val batch = SampleBatch()
        assertThrows(IllegalArgumentException::class.java) { batch.bleSighting(0, -60f, ByteArray(5)) }
        assertThrows(IllegalArgumentException::class.java) { batch.ibeaconSighting(0, -60f, ByteArray(16), 65536, 0) }
        assertThrows(IllegalArgumentException::class.java) { batch.ibeaconSighting(0, -60f, ByteArray(16), 0, -1) }
        assertEquals(0, batch.size)
    }
}
