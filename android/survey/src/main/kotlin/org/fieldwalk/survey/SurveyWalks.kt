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
import org.fieldwalk.WalkReport
import org.fieldwalk.Waypoint
import org.fieldwalk.android.PhoneSensors
import org.fieldwalk.android.RadioUse
import org.fieldwalk.android.Sensing
import org.fieldwalk.android.SensorClock
import org.fieldwalk.android.Trouble
import org.fieldwalk.android.TroubleKind
import java.io.File
import java.nio.ByteBuffer
import java.util.concurrent.Executor
import kotlin.math.hypot

/**
 * A survey as the app drives it: sensors into the engine and into a recording while a walk is on, waypoints at taps, a state
 * to show. All calls come from the main thread.
 *
 * @param background runs what takes seconds
 */
class SurveyWalks(context: Context, private val folder: SurveyFolder, private val background: Executor) {
    private val surveyor = folder.surveyor()
    private val sensing = Sensing(beacons = RadioUse.CONTINUOUS)
    private val sensors = PhoneSensors(context, sensing, push = ::push, report = ::report, fail = ::fail)
    private val mutable = MutableStateFlow(SurveyState())

    /** Set while a walk is on and not paused: on the sensors' thread samples go there. */
    @Volatile private var walk: SurveyFolder.OpenWalk? = null
    @Volatile private var isPaused = false
    @Volatile private var troubles = emptyList<Trouble>()
    private var lastTap: Waypoint? = null
    private var isTooFast = false

    val state: StateFlow<SurveyState> = mutable.asStateFlow()
    val drawing: FloorDrawing = surveyor.drawing()
    val floor: String = folder.floor

    init {
        restore()
    }

    /** Looks how the walk fares; called now and then. */
    fun look() = mutable.update { state ->
        val status = surveyor.status()
        if (!state.canEnd) return@update state.copy(warnings = emptySet())
        state.copy(nSteps = status.nSteps.toInt(), warnings = warnings(status))
    }

    /** Begins a walk and starts the sensors. */
    fun beginWalk() = attempt(Phase.IDLE) {
        surveyor.beginWalk("walk ${state.value.nWalks + 1}")
        walk = folder.beginWalk()
        start()
    }

    /** The surveyor stands at [point]. */
    fun tap(point: Point2) = attempt(Phase.WALKING) {
        // What was sensed before the tap belongs to the line that ends here.
        sensors.flush()
        val waypoint = Waypoint(SensorClock.nowNs(), point)
        surveyor.pushWaypoint(waypoint)
        walk?.tap(waypoint)
        isTooFast = lastTap?.let { speedMS(it, waypoint) > FASTEST_M_S } == true
        lastTap = waypoint
        mutable.update { it.copy(taps = it.taps + point, coverage = surveyor.coverage()) }
        look()
    }

    /** Takes the last waypoint back; with none left in the walk, nothing. */
    fun undoTap() = attempt(Phase.WALKING) {
        val undone = surveyor.undoWaypoint() ?: return@attempt
        walk?.undo(undone)
        lastTap = null
        isTooFast = false
        mutable.update { it.copy(taps = it.taps.dropLast(1), coverage = surveyor.coverage()) }
    }

    /** Pauses the walk: the surveyor is held up or goes elsewhere. */
    fun pause() = attempt(Phase.WALKING) {
        sensors.flush()
        surveyor.pause()
        walk?.pause(SensorClock.nowNs())
        isPaused = true
        mutable.update { it.copy(phase = Phase.PAUSED) }
    }

    /** Goes on with it from another place, which is the next waypoint. */
    fun resume() = attempt(Phase.PAUSED) {
        // What was sensed during the pause is dropped.
        sensors.flush()
        surveyor.resume()
        start()
    }

    /** Ends the walk and stops the sensors. */
    fun endWalk() {
        if (!state.value.canEnd) return
        attempt(state.value.phase) {
            sensors.stop()
            walk?.finish()
            walk = null
            mutable.update { it.copy(phase = Phase.IDLE, taps = emptyList(), warnings = emptySet()) }
            take(surveyor.endWalk())
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
                        check(whole.renameTo(folder.mapFile)) { "the map cannot be put into its place" }
                    }
                }
            }.exceptionOrNull()
            mutable.update { it.copy(phase = Phase.IDLE, mishap = failure?.let(Mishap::Failed), hasMap = folder.mapFile.isFile) }
        }
    }

    /** Stops the sensors without ending the walk, as the end of the app would. */
    fun abandon() = sensors.stop()

    /** Gives the surveyor all that was recorded; a walk that the end of the app cut counts up to its last second. */
    private fun restore() {
        for (recording in folder.recordings()) {
            try {
                surveyor.beginWalk("walk ${recording.nameWithoutExtension}")
                folder.replay(recording, surveyor)
                take(surveyor.endWalk(), recording)
            } catch (refused: ApiException) {
                // Cut before its first second, it holds nothing.
                runCatching { surveyor.discardWalk() }
                folder.drop(recording)
                mutable.update { it.copy(mishap = Mishap.Failed(refused)) }
            }
        }
        mutable.update { it.copy(coverage = surveyor.coverage(), hasMap = folder.mapFile.isFile) }
    }

    private fun start() {
        lastTap = null
        isTooFast = false
        isPaused = false
        mutable.update { it.copy(phase = Phase.WALKING, taps = emptyList(), nSteps = 0) }
        sensors.start()
    }

    private fun take(report: WalkReport, recording: File? = folder.recordings().lastOrNull()) {
        if (!report.isUsed) recording?.let(folder::drop)
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
    private fun push(batch: ByteBuffer) {
        if (isPaused) return
        surveyor.pushSamples(batch.duplicate().order(batch.order()))
        walk?.push(batch)
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
            if (TroubleKind.SENSOR_ABSENT in kinds || MissingInput.ACCELEROMETER in missing) add(Warning.SENSORS)
        }
    }

    private fun attempt(phase: Phase, step: () -> Unit) {
        if (state.value.phase != phase) return
        mutable.update { it.copy(mishap = null) }
        try {
            step()
        } catch (refused: ApiException) {
            mutable.update { it.copy(mishap = Mishap.Failed(refused)) }
        }
    }

    private fun speedMS(from: Waypoint, to: Waypoint): Double =
        hypot(to.point.xM - from.point.xM, to.point.yM - from.point.yM) / maxOf((to.timeNs - from.timeNs) * 1e-9, 1e-3)

    private companion object {
        /** Who goes faster runs, or tapped late. */
        const val FASTEST_M_S = 1.8
    }
}
