package org.fieldwalk.survey

import android.content.Context
import kotlinx.coroutines.flow.MutableStateFlow
import kotlinx.coroutines.flow.StateFlow
import kotlinx.coroutines.flow.asStateFlow
import kotlinx.coroutines.flow.update
import org.fieldwalk.ApiException
import org.fieldwalk.BuildingMap
import org.fieldwalk.FloorDrawing
import org.fieldwalk.MissingInput
import org.fieldwalk.Point2
import org.fieldwalk.SurveyStatus
import org.fieldwalk.Surveyor
import org.fieldwalk.WalkReport
import org.fieldwalk.Waypoint
import org.fieldwalk.android.PhoneSensors
import org.fieldwalk.android.RadioUse
import org.fieldwalk.android.Sensing
import org.fieldwalk.android.SensorClock
import org.fieldwalk.android.Trouble
import org.fieldwalk.android.TroubleKind
import java.io.File
import java.io.IOException
import java.nio.ByteBuffer
import java.util.concurrent.Executor
import kotlin.math.hypot

/**
 * A survey as the app drives it: sensors into the engine and into a recording while a walk is on, waypoints at taps, a state
 * to show. All calls come from the main thread.
 *
 * What the disk may refuse is done before the engine is told, or undone there: a full disk leaves a walk that can be ended.
 *
 * @param background runs what takes seconds
 */
class SurveyWalks(
    context: Context,
    private val folder: SurveyFolder,
    private val background: Executor,
    private val surveyor: Surveyor = folder.surveyor(),
) {
    private val sensing = Sensing(beacons = RadioUse.CONTINUOUS)
    private val sensors = PhoneSensors(context, sensing, push = ::push, report = ::report, fail = ::fail)
    private val mutable = MutableStateFlow(SurveyState())

    /** Set while a walk is on and not paused: on the sensors' thread samples go there, one batch at a time under [gate]. */
    private var part: SurveyFolder.OpenPart? = null
    private val gate = Any()
    private var lastPart: File? = null
    @Volatile private var troubles = emptyList<Trouble>()
    private var lastTap: Waypoint? = null
    private var isTooFast = false

    val state: StateFlow<SurveyState> = mutable.asStateFlow()
    val drawing: FloorDrawing = surveyor.drawing()
    val floor: String = folder.floor

    /** The survey's, not the floor's. */
    val name: String = folder.name

    init {
        restore()
    }

    /** Looks how the walk fares; called now and then. */
    fun look() {
        if (!state.value.canEnd) return mutable.update { it.copy(warnings = emptySet()) }
        try {
            val status = surveyor.status()
            mutable.update { it.copy(nSteps = status.nSteps.toInt(), warnings = warnings(status)) }
        } catch (broken: ApiException) {
            fail(broken)
        }
    }

    /** Begins a walk and starts the sensors. */
    fun beginWalk() = attempt(Phase.IDLE) {
        val begun = folder.beginWalk()
        try {
            surveyor.beginWalk("walk ${state.value.nWalks + 1}")
        } catch (refused: ApiException) {
            runCatching { begun.finish() }
            folder.drop(begun.recording)
            throw refused
        }
        start(begun)
    }

    /** The surveyor stands at [point]. */
    fun tap(point: Point2) = attempt(Phase.WALKING) {
        // What was sensed before the tap belongs to the line that ends here.
        sensors.flush()
        val waypoint = Waypoint(SensorClock.nowNs(), point)
        surveyor.pushWaypoint(waypoint)
        try {
            part?.tap(waypoint)
        } catch (unwritten: ApiException) {
            surveyor.undoWaypoint()
            throw unwritten
        }
        isTooFast = lastTap?.let { speedMS(it, waypoint) > FASTEST_M_S } == true
        lastTap = waypoint
        mutable.update { it.copy(taps = it.taps + point, coverage = surveyor.coverage()) }
        look()
    }

    /** Takes the last waypoint back; with none left in the walk, nothing. */
    fun undoTap() = attempt(Phase.WALKING) {
        part?.undo(surveyor.status().lastWaypoint ?: return@attempt)
        surveyor.undoWaypoint()
        lastTap = null
        isTooFast = false
        mutable.update { it.copy(taps = it.taps.dropLast(1), coverage = surveyor.coverage()) }
    }

    /** Pauses the walk: the surveyor is held up or goes elsewhere. */
    fun pause() = attempt(Phase.WALKING) {
        sensors.flush()
        part?.flush()
        surveyor.pause()
        mutable.update { it.copy(phase = Phase.PAUSED) }
        finishPart()
    }

    /** Goes on with it from another place, which is the next waypoint. */
    fun resume() = attempt(Phase.PAUSED) {
        // What was sensed during the pause is dropped.
        sensors.flush()
        val begun = lastPart?.let(folder::beginPart) ?: return@attempt
        try {
            surveyor.resume()
        } catch (refused: ApiException) {
            runCatching { begun.finish() }
            folder.drop(begun.recording)
            throw refused
        }
        start(begun)
    }

    /** Ends the walk and stops the sensors. */
    fun endWalk() {
        if (!state.value.canEnd) return
        attempt(state.value.phase) {
            sensors.stop()
            // Whatever refuses below: the walk is over, and another can begin.
            mutable.update { it.copy(phase = Phase.IDLE, taps = emptyList(), warnings = emptySet()) }
            try {
                finishPart()
            } finally {
                take(surveyor.endWalk())
            }
        }
    }

    /** Drops the last walk that ended. */
    fun undoWalk() = attempt(Phase.IDLE) {
        surveyor.undoWalk() ?: return@attempt
        folder.dropLastWalk()
        mutable.update { it.copy(walkLengthsM = it.walkLengthsM.dropLast(1), coverage = surveyor.coverage(), accuracy = null) }
        expect()
    }

    /** Builds the map into the survey's folder; what goes wrong is the mishap. */
    fun build() = attempt(Phase.IDLE) {
        if (!state.value.canBuild) return@attempt
        mutable.update { it.copy(phase = Phase.BUILDING) }
        background.execute {
            val failure = runCatching {
                surveyor.build().use { surveyed ->
                    BuildingMap.ofSurvey(floor, listOf(surveyed)).use { map ->
                        val whole = File(folder.folder, "map.part")
                        whole.writeBytes(map.export())
                        if (!whole.renameTo(folder.mapFile)) throw IOException("the map cannot be put into its place")
                    }
                }
            }.exceptionOrNull()
            mutable.update { it.copy(phase = Phase.IDLE, mishap = failure?.let(Mishap::Failed), hasMap = folder.mapFile.isFile) }
        }
    }

    /** Makes the recordings fit to be shared, and tells whether they are. */
    fun readyToShare(): Boolean {
        attempt(Phase.IDLE) {
            folder.leaveOutUndone()
            // A full disk, which sharing may help to clear, must not hinder it.
            runCatching { folder.noteShared() }
        }
        return state.value.canShare && state.value.mishap == null
    }

    /** Stops the sensors without ending the walk, as the end of the app would. */
    fun abandon() = sensors.stop()

    /** Gives the surveyor all that was recorded; a walk that the end of the app cut counts up to its last second. */
    private fun restore() {
        val aside = mutableListOf<String>()
        try {
            for (walk in folder.walks()) restore(walk, aside)
            mutable.update { it.copy(coverage = surveyor.coverage()) }
        } catch (broken: ApiException) {
            // Whatever comes next would be refused as well: that says nothing of the recordings.
            fail(broken)
        } catch (immovable: IOException) {
            fail(immovable)
        }
        mutable.update { it.copy(hasMap = folder.mapFile.isFile) }
        if (aside.isNotEmpty()) mutable.update { it.copy(mishap = Mishap.PutAside(aside, it.mishap)) }
    }

    /** Restores the walk of these parts; what cannot be goes to [aside], and the others are tried without it. */
    private fun restore(parts: List<File>, aside: MutableList<String>) {
        if (parts.isEmpty()) return
        surveyor.beginWalk("walk ${parts.first().name.substringBefore('-')}")
        for ((k, recording) in parts.withIndex()) {
            val refusal = replay(recording, isFirst = k == 0) ?: continue
            surveyor.discardWalk()
            fail(refusal)
            if (folder.putAside(recording)) aside.add(recording.name)
            return restore(parts - recording, aside)
        }
        val report = surveyor.endWalk()
        if (report.isUsed) return take(report)
        mutable.update { it.copy(mishap = Mishap.Unused(report)) }
        parts.filter(folder::putAside).mapTo(aside) { it.name }
    }

    /** Why the engine did not take a part; that it is broken says nothing of the part. */
    private fun replay(recording: File, isFirst: Boolean): Exception? = try {
        if (!isFirst) {
            surveyor.pause()
            surveyor.resume()
        }
        folder.replay(recording, surveyor)
        null
    } catch (broken: ApiException.Broken) {
        throw broken
    } catch (refused: ApiException) {
        refused
    } catch (unreadable: IOException) {
        unreadable
    }

    private fun start(begun: SurveyFolder.OpenPart) {
        lastTap = null
        isTooFast = false
        lastPart = begun.recording
        synchronized(gate) { part = begun }
        mutable.update { it.copy(phase = Phase.WALKING, taps = emptyList(), nSteps = 0) }
        sensors.start()
    }

    private fun finishPart() {
        val ended = part
        synchronized(gate) { part = null }
        ended?.finish()
    }

    private fun take(report: WalkReport) {
        if (!report.isUsed) folder.dropLastWalk()
        mutable.update { state ->
            if (report.isUsed) state.copy(walkLengthsM = state.walkLengthsM + report.routeM, coverage = surveyor.coverage())
            else state.copy(mishap = Mishap.Unused(report), coverage = surveyor.coverage())
        }
        if (report.isUsed) expect()
    }

    /** Tells anew what errors to expect, when somebody has time. */
    private fun expect() {
        val nWalks = state.value.nWalks
        if (nWalks < 2) return
        background.execute {
            // Walks that have ended since then will tell it better.
            if (state.value.nWalks != nWalks) return@execute
            val accuracy = runCatching { surveyor.build().use { it.expectedAccuracy() } }.getOrNull()
            mutable.update { if (it.nWalks == nWalks) it.copy(accuracy = accuracy) else it }
        }
    }

    /** On the sensors' thread. */
    private fun push(batch: ByteBuffer) = synchronized(gate) {
        part?.let {
            surveyor.pushSamples(batch.duplicate().order(batch.order()))
            it.push(batch)
        } ?: Unit
    }

    private fun report(troubles: List<Trouble>) {
        this.troubles = troubles
    }

    private fun fail(failure: Throwable) = mutable.update { it.copy(mishap = Mishap.Failed(failure)) }

    private fun warnings(status: SurveyStatus): Set<Warning> {
        val kinds = troubles.map { it.kind }.toSet()
        val missing = status.missing.map { it.what }
        return buildSet {
            if (isTooFast) add(Warning.TOO_FAST)
            if (state.value.taps.size > 1 && status.nSteps == 0u) add(Warning.NO_STEPS)
            status.carryWarning?.let { add(Warning.of(it.what)) }
            if (TroubleKind.CALIBRATION in kinds) add(Warning.CALIBRATION)
            if (kinds.any { it.name.startsWith("BLUETOOTH") }) add(Warning.BLUETOOTH)
            if (kinds.any { it.name.startsWith("LOCATION") }) add(Warning.LOCATION)
            if (TroubleKind.SENSOR_ABSENT in kinds || missing.any { it in SENSORS }) add(Warning.SENSORS)
        }
    }

    private fun attempt(phase: Phase, step: () -> Unit) {
        if (state.value.phase != phase) return
        mutable.update { it.copy(mishap = null) }
        try {
            step()
        } catch (refused: ApiException) {
            fail(refused)
        } catch (unwritten: IOException) {
            fail(unwritten)
        }
    }

    private fun speedMS(from: Waypoint, to: Waypoint): Double =
        hypot(to.point.xM - from.point.xM, to.point.yM - from.point.yM) / maxOf((to.timeNs - from.timeNs) * 1e-9, 1e-3)

    private companion object {
        /** Who goes faster runs, or tapped late. */
        const val FASTEST_M_S = 1.8
        /** Without any of them a walk makes no map. */
        val SENSORS = setOf(MissingInput.ACCELEROMETER, MissingInput.GYROSCOPE, MissingInput.MAGNETOMETER)
    }
}
