package org.fieldwalk.survey

import org.fieldwalk.ExpectedAccuracy
import org.fieldwalk.Point2
import org.fieldwalk.SurveyCoverage

enum class Phase { IDLE, WALKING, PAUSED, BUILDING }

/** Something that makes a walk worth less. */
enum class Warning { TOO_FAST, NO_STEPS, CALIBRATION, BLUETOOTH, LOCATION, SENSORS }

/** What the screen shows. */
data class SurveyState(
    val phase: Phase = Phase.IDLE,
    /** The waypoints since the walk began or was resumed. */
    val taps: List<Point2> = emptyList(),
    /** Steps since then. */
    val nSteps: Int = 0,
    val warnings: Set<Warning> = emptySet(),
    /** Lengths of the walks that the map will use, in metres. */
    val walkLengthsM: List<Double> = emptyList(),
    val coverage: SurveyCoverage? = null,
    /** What errors to expect; null until a walk can be left out to tell it. */
    val accuracy: ExpectedAccuracy? = null,
    /** What went wrong last, and what to do about it: the engine's words. */
    val message: String? = null,
    val hasMap: Boolean = false,
) {
    val nWalks: Int get() = walkLengthsM.size
    val routeM: Double get() = walkLengthsM.sum()
    val canBegin get() = phase == Phase.IDLE
    val canTap get() = phase == Phase.WALKING
    val canUndoTap get() = phase == Phase.WALKING && taps.isNotEmpty()
    val canPause get() = phase == Phase.WALKING
    val canResume get() = phase == Phase.PAUSED
    val canEnd get() = phase == Phase.WALKING || phase == Phase.PAUSED
    val canUndoWalk get() = phase == Phase.IDLE && nWalks > 0
    val canBuild get() = phase == Phase.IDLE && nWalks > 0

    /** The covered part of what is open, in per cent. */
    val coveredPercent: Int
        get() = coverage?.totals?.let { if (it.openM2 > 0) (100 * it.coveredM2 / it.openM2).toInt().coerceAtMost(100) else 0 } ?: 0
}
