package org.fieldwalk

import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertFalse
import org.junit.jupiter.api.Assertions.assertNull
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.junit.jupiter.api.io.TempDir
import java.io.File

/** A survey as an app makes it, and the recordings of its walks. */
class SurveyTest {
    private val waypoints = Walk.waypoints.map { Waypoint(it.timeNs, it.point) }

    private fun surveyor() = Surveyor(Walk.plan.toDirect(), "F1", 0)

    /** Gives every batch, and every waypoint after the samples before it. */
    private fun walk(push: (java.nio.ByteBuffer) -> Unit, tap: (Waypoint) -> Unit) {
        val batch = SampleBatch()
        fun flush() {
            push(batch.bytes())
            batch.clear()
        }
        for (record in Walk.records) {
            if (record.kind == "waypoint") {
                flush()
                tap(Waypoint(record.timeNs, record.point))
            } else {
                record.addTo(batch)
                if (batch.size == 200) flush()
            }
        }
        flush()
    }

    @Test
    fun `a walk becomes a map that positions it, as one file and as a folder`(@TempDir folder: File) = surveyor().use { surveyor ->
        surveyor.beginWalk("morning")
        walk(surveyor::pushSamples, surveyor::pushWaypoint)
        val report = surveyor.endWalk()
        assertTrue(report.isUsed && report.nSteps > 50u, "$report")
        val coverage = surveyor.coverage()
        // The walk goes round the whole ring.
        assertTrue(coverage.totals.coveredM2 > 50.0 && coverage.totals.coveredM2 == coverage.totals.openM2, "$coverage")
        assertEquals((coverage.nColumns * coverage.nRows).toInt(), coverage.nodes.size)
        surveyor.build().use { floor ->
            assertEquals(FloorInfo("F1", 0, 26.0, 20.0), floor.info())
            assertNull(floor.expectedAccuracy(), "of a single walk nothing can be left out")
            BuildingMap.ofSurvey("office", listOf(floor)).use { map ->
                map.save(File(folder, "map").path)
                val maps = listOf(BuildingMap.fromFile(map.export().toDirect()), BuildingMap.open(File(folder, "map").path))
                val fixes = (maps + map).map { opened ->
                    Positioner(opened, 0).use { positioner ->
                        positioner.hint(PositionHint(Walk.start.point, 2.0, 0, Walk.start.timeNs))
                        positioner.pushSamples(batchOf(Walk.samples).bytes())
                    }
                }
                assertTrue(fixes[0].size > 50 && fixes[0] == fixes[1] && fixes[1] == fixes[2])
                maps.forEach { it.close() }
            }
        }
    }

    @Test
    fun `slips are mended by undo, pause and discard, and what does not fit is refused`() = surveyor().use { surveyor ->
        assertEquals(26.0 to 20.0, surveyor.drawing().let { it.widthM to it.heightM })
        assertThrows(ApiException.OutOfTurn::class.java) { surveyor.pause() }
        surveyor.beginWalk("slips")
        surveyor.pushWaypoint(waypoints[0])
        assertThrows(ApiException.BadWaypoint::class.java) { surveyor.pushWaypoint(waypoints[0]) }
        surveyor.pushWaypoint(waypoints[1])
        val covered = surveyor.coverage().totals.coveredM2
        assertEquals(waypoints[1], surveyor.undoWaypoint())
        assertTrue(surveyor.coverage().totals.coveredM2 < covered)
        surveyor.pause()
        assertTrue(surveyor.status().isPaused)
        assertThrows(ApiException.OutOfTurn::class.java) { surveyor.pushWaypoint(waypoints[1]) }
        surveyor.resume()
        assertEquals("slips", surveyor.discardWalk())
        assertThrows(ApiException.SurveyIncomplete::class.java) { surveyor.build() }
        assertThrows(ApiException.PlanMalformed::class.java) { Surveyor(ByteArray(3).toDirect(), "F1", 0) }
        Unit
    }

    @Test
    fun `a recording cut by a crash is read to its end and surveyed`(@TempDir folder: File) {
        val file = File(folder, "walk.mcap")
        val recorder = Recorder(file.path, RecordingDetails(device = "a JVM", floor = "F1"))
        walk(recorder::pushSamples, recorder::pushWaypoint)
        recorder.flush()
        // As a crash leaves it: without its end.
        val torn = File(folder, "torn.mcap").also { file.copyTo(it) }
        assertThrows(ApiException.FileExists::class.java) { Recorder(file.path).close() }
        assertEquals(Walk.samples.size.toULong(), recorder.finish().nSamples)
        assertThrows(ApiException.Finished::class.java) { recorder.pushWaypoint(waypoints[0]) }
        recorder.close()

        var nSamples = 0u
        val read = mutableListOf<Waypoint>()
        RecordingReader.open(torn.path).use { reader ->
            generateSequence { reader.nextPart(777u) }.forEach { part ->
                nSamples += part.nSamples
                part.waypoint?.let(read::add)
            }
            assertTrue(reader.losses().wasCut)
            assertEquals("a JVM" to 0, reader.details().device to reader.floor())
        }
        assertEquals(Walk.samples.size.toUInt() to waypoints, nSamples to read)
        surveyor().use { surveyor ->
            assertTrue(surveyor.addRecording(torn.path, "after the crash").isUsed)
            assertEquals("after the crash", surveyor.undoWalk())
            assertThrows(ApiException.RecordingNotFound::class.java) { surveyor.addRecording(folder.path + "/none", "w") }
        }
    }

    @Test
    fun `a recording replayed gives the fixes of its samples`() = Walk.openMap().use { map ->
        fun follow(parts: Sequence<RecordingPart>) = Positioner(map, 0).use { positioner ->
            parts.flatMap { part ->
                val fixes = positioner.pushSamples(part.samples.toDirect())
                if (positioner.fix() == null) {
                    part.waypoint?.let { positioner.hint(PositionHint(it.point, 2.0, 0, it.timeNs)) }
                }
                fixes
            }.toList()
        }
        val fixes = listOf(50u, 100_000u).map { maxSamples ->
            RecordingReader.open(Walk.log.path).use { reader -> follow(generateSequence { reader.nextPart(maxSamples) }) }
        }
        assertTrue(fixes[0].size > 50)
        assertEquals(fixes[0], fixes[1])
    }

    @Test
    fun `a swing, a card and an iBeacon are judged`() {
        MagnetometerCalibrator().use { calibrator ->
            calibrator.pushSamples(batchOf(Walk.samples.take(10)).bytes())
            val verdict = calibrator.verdict()
            assertTrue(verdict is SwingVerdict.SwingAgain && verdict.fault == SwingFault.TOO_SHORT, "$verdict")
        }
        CardDecoder().use { decoder ->
            val frame = ByteArray(31)
            byteArrayOf(2, 1, 6, 0x1b, -1, -1, -1, 0x11, 100, 7, 42).copyInto(frame)
            val round = decoder.decodeAdvertisement(frame.toDirect())
            assertEquals(listOf<Any?>(42.toUShort(), 7.toUByte(), true), listOf(round.cardId, round.sequence, round.isCalibrated))
            assertNull(round.nLost)
            assertEquals(listOf(0f, 0f, 0f) to listOf<Float?>(null, null, null), round.verticalFieldUt to round.previousStrengthUt)
            assertTrue(decoder.decodeAdvertisement(frame.toDirect()).isRepeated)
            frame[7] = 0x21
            assertThrows(ApiException.AdvertisementTooNew::class.java) { decoder.decodeAdvertisement(frame.toDirect()) }
            assertThrows(ApiException.AdvertisementMalformed::class.java) { decoder.decodeAdvertisement(ByteArray(5).toDirect()) }
            assertThrows(ApiException.AdvertisementForeign::class.java) { decodeIbeacon(frame.toDirect()) }
        }
        val beacon = byteArrayOf(2, 1, 6, 0x1a, -1, 0x4c, 0, 2, 0x15) + ByteArray(16) { it.toByte() } + byteArrayOf(2, 1, 0, 7, -59)
        val read = decodeIbeacon(beacon.toDirect())
        assertEquals(513.toUShort() to (-59).toByte(), read.major to read.measuredPowerDbm)
        assertFalse(read.uuid.isEmpty())
    }
}
