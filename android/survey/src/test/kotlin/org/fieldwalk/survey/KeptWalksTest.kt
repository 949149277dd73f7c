package org.fieldwalk.survey

import org.fieldwalk.ApiException
import org.fieldwalk.Recorder
import org.fieldwalk.RecordingDetails
import org.fieldwalk.RecordingReader
import org.fieldwalk.Surveyor
import org.fieldwalk.Waypoint
import org.fieldwalk.android.SensorClock
import org.fieldwalk.android.SimulatedPhone
import org.junit.After
import org.junit.Assert.assertEquals
import org.junit.Assert.assertTrue
import org.junit.Before
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.RobolectricTestRunner
import java.io.File
import java.nio.ByteBuffer
import java.nio.file.Files
import java.nio.file.Path

/** What a full disk, a damaged file and a fault of the engine leave of a survey. */
@RunWith(RobolectricTestRunner::class)
class KeptWalksTest {
    private val phone = SimulatedPhone().also { it.grantAll() }
    private val disk = FullDisk()
    private val folder = SurveyFolder(File(phone.context.filesDir, "kept"), disk::record)
    private val later = ArrayDeque<Runnable>()
    private lateinit var walks: SurveyWalks
    private val recorded = RecordedFloor.surveyWalks.first()

    @Before
    fun begin() {
        phone.clockTo(1_000_000_000_000)
        folder.create(RecordedFloor.plan, "F1", 0)
        open()
    }

    @After
    fun end() {
        walks.abandon()
        folder.folder.deleteRecursively()
    }

    @Test
    fun `a walk ends though the disk is full, and another begins when it is not`() {
        walks.beginWalk()
        walk(4)
        disk.isFull = true
        walks.endWalk()
        assertEquals(Phase.IDLE, state.phase)
        assertTrue("${state.mishap}", failure is ApiException.StorageFull)
        assertEquals("what was walked counts", 1, state.nWalks)
        walks.endWalk()
        disk.isFull = false
        walks.beginWalk()
        walk(4)
        walks.endWalk()
        assertEquals(null, state.mishap)
        assertEquals(2, state.nWalks)
        open()
        assertEquals("both are on the disk", 2, state.nWalks)
    }

    @Test
    fun `a walk that the disk has no room for does not begin`() {
        disk.isFull = true
        walks.beginWalk()
        assertEquals(Phase.IDLE, state.phase)
        assertTrue(failure is ApiException.StorageFull)
        assertEquals("nothing half written", emptyList<File>(), folder.recordings())
        disk.isFull = false
        walks.beginWalk()
        assertEquals(Phase.WALKING, state.phase)
    }

    @Test
    fun `neither a tap nor its undoing nor a pause is half done on a full disk`() {
        walks.beginWalk()
        walk(3)
        val covered = state.coverage!!.totals
        // The journal's disk is full as well.
        val journal = File(folder.folder, "1-1.journal").toPath()
        Files.createSymbolicLink(journal, Path.of("/dev/full"))
        walks.undoTap()
        assertTrue("${state.mishap}", English.remedies.say(state.mishap!!) == "The phone is full: free some space.")
        assertEquals(3, state.taps.size)
        disk.isFull = true
        walks.pause()
        assertTrue(failure is ApiException.StorageFull)
        assertEquals(Phase.WALKING, state.phase)
        phone.pass(1_000)
        walks.tap(state.taps.first())
        assertTrue(failure is ApiException.StorageFull)
        assertEquals(3, state.taps.size)
        assertEquals(covered, open.coverage().totals)
        disk.isFull = false
        Files.delete(journal)
        walks.pause()
        assertEquals(Phase.PAUSED, state.phase)
        walks.resume()
        assertEquals(null, state.mishap)
        walk(2)
        walks.undoTap()
        assertEquals(1, state.taps.size)
        walks.endWalk()
        assertEquals(1, state.nWalks)
    }

    @Test
    fun `a recording that cannot be restored is put aside, not deleted`() {
        repeat(2) {
            walks.beginWalk()
            walk(4)
            walks.endWalk()
        }
        val (first, second) = folder.recordings()
        // The second's head is gone, its samples are not; a third was cut before it held anything.
        val bytes = second.readBytes().also { it.fill(0, 0, 8) }
        second.writeBytes(bytes)
        File(folder.folder, "3-1.mcap").writeBytes(ByteArray(0))
        open()
        assertEquals(listOf(first), folder.recordings())
        assertEquals(listOf("2-1.mcap.bad"), folder.aside().map { it.name })
        assertTrue(folder.aside().single().readBytes().contentEquals(bytes))
        assertEquals(1, state.nWalks)
        val said = English.remedies.say(state.mishap!!)
        assertTrue(said, "2-1.mcap" in said && "3-1.mcap" !in said && "damaged" in said)
        // A new walk takes no number of one that was put aside.
        walks.beginWalk()
        walk(4)
        walks.endWalk()
        assertEquals(listOf("1-1.mcap", "3-1.mcap"), folder.recordings().map { it.name })
    }

    @Test
    fun `a walk without lines is put aside too, an unwritten one is not`() {
        walks.beginWalk()
        walk(1)
        walks.abandon()
        open()
        assertEquals(listOf("1-1.mcap.bad"), folder.aside().map { it.name })
        walks.beginWalk()
        walks.abandon()
        open()
        assertEquals("nothing was sensed", 1, folder.aside().size)
        assertEquals(emptyList<File>(), folder.recordings())
    }

    @Test
    fun `a fault of the engine costs no recording`() {
        repeat(2) {
            walks.beginWalk()
            walk(4)
            walks.endWalk()
        }
        val before = folder.recordings().map { it.name to it.length() }
        open(BrokenSurveyor(RecordedFloor.plan, nWhole = 1))
        assertTrue("${state.mishap}", failure is ApiException.Broken)
        walks.look()
        walks.beginWalk()
        walks.undoWalk()
        walks.look()
        assertEquals(Phase.IDLE, state.phase)
        assertEquals(before, folder.recordings().map { it.name to it.length() })
        open()
        assertEquals(2, state.nWalks)
    }

    @Test
    fun `the host surveys what is shared as the app did`() {
        walks.beginWalk()
        walk(4)
        walks.undoTap()
        walks.pause()
        // The surveyor goes back to the start, which the pause bridges.
        phone.pass(20_000)
        walks.resume()
        walk(3)
        walks.undoTap()
        walk(2)
        walks.endWalk()
        val taken = open.coverage().totals
        val length = state.routeM
        assertTrue(walks.readyToShare())
        assertEquals(listOf("1-1.mcap", "1-2.mcap"), folder.recordings().map { it.name })
        assertEquals("no journal is needed", emptyList<String>(), folder.folder.list()!!.filter { "journal" in it })
        val n = folder.recordings().map { recording ->
            RecordingReader.open(recording.path).use { reader ->
                generateSequence { reader.nextPart(UInt.MAX_VALUE) }.count { it.waypoint != null }
            }
        }
        assertEquals(listOf(3, 4), n)
        folder.surveyor().use { host ->
            val reports = folder.recordings().map { host.addRecording(it.path, it.name) }
            assertTrue("$reports", reports.all { it.isUsed })
            assertEquals(length, reports.sumOf { it.routeM }, 1e-9)
            assertEquals(taken, host.coverage().totals)
        }
        open()
        assertEquals(taken, open.coverage().totals)
        assertEquals("one walk, of two parts", 1, state.nWalks)
        walks.undoWalk()
        assertEquals(emptyList<File>(), folder.recordings())
    }

    @Test
    fun `a damaged part is put aside alone`() {
        walks.beginWalk()
        walk(4)
        walks.pause()
        walks.resume()
        walk(4)
        walks.endWalk()
        val first = folder.recordings().first()
        first.writeBytes(first.readBytes().also { it.fill(0, 0, 8) })
        open()
        assertEquals(listOf("1-2.mcap"), folder.recordings().map { it.name })
        assertEquals(1, state.nWalks)
        assertTrue(state.routeM > 0)
    }

    private val state get() = walks.state.value
    private val failure get() = (state.mishap as? Mishap.Failed)?.cause
    private lateinit var open: Surveyor

    /** As after the end of the app. */
    private fun open(surveyor: Surveyor = folder.surveyor()) {
        if (::walks.isInitialized) walks.abandon()
        open = surveyor
        walks = SurveyWalks(phone.context, folder, later::add, surveyor)
    }

    private fun walk(nWaypoints: Int) {
        var n = 0
        records(recorded, SensorClock.nowNs() + 1_000_000_000) { record, waypoint ->
            if (n >= nWaypoints) return@records
            record?.let(phone::deliver)
            waypoint?.let {
                phone.clockTo(it.timeNs)
                walks.tap(it.point)
                n += 1
            }
        }
        phone.settle()
    }
}

/** Recordings on a disk that may be full. */
private class FullDisk {
    var isFull = false

    fun record(path: String, details: RecordingDetails): Recorder {
        if (isFull) File(path).createNewFile()
        check()
        return object : Recorder(path, details) {
            override fun pushWaypoint(waypoint: Waypoint) = check().also { super.pushWaypoint(waypoint) }

            override fun flush() = check().also { super.flush() }

            override fun finish() = super.finish().also { check() }
        }
    }

    private fun check() {
        if (isFull) throw ApiException.StorageFull("full", "free some space")
    }
}

/** A surveyor that panics at the first samples after so many walks: from then on it refuses everything. */
private class BrokenSurveyor(plan: ByteArray, private val nWhole: Int) : Surveyor(plan.toDirect(), "F1", 0) {
    private var nBegun = 0
    private var isBroken = false

    override fun beginWalk(name: String) = unlessBroken { super.beginWalk(name) }.also { nBegun += 1 }

    override fun pushSamples(batch: ByteBuffer) {
        isBroken = isBroken || nBegun > nWhole
        unlessBroken { super.pushSamples(batch) }
    }

    override fun discardWalk() = unlessBroken { super.discardWalk() }
    override fun status() = unlessBroken { super.status() }
    override fun coverage() = unlessBroken { super.coverage() }
    override fun undoWalk() = unlessBroken { super.undoWalk() }

    private fun <T> unlessBroken(call: () -> T): T = if (isBroken) throw ApiException.Broken("a fault", "restart") else call()
}
