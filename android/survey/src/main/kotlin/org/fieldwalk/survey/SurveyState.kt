package org.fieldwalk.survey

import org.fieldwalk.CarryFault
import org.fieldwalk.ExpectedAccuracy
import org.fieldwalk.Point2
import org.fieldwalk.SurveyCoverage

enum class Phase { IDLE, WALKING, PAUSED, BUILDING }

/** Something that makes a walk worth less. */
enum class Warning {
    TOO_FAST, NO_STEPS, NOT_HELD, NOT_UPWARD, NOT_FORWARD, NOT_LEVEL, CALIBRATION, BLUETOOTH, LOCATION, SENSORS;

    companion object {
        /** What the phone's owner is to be told of the way in which it is carried. */
        fun of(fault: CarryFault) = when (fault) {
            CarryFault.NOT_HELD, CarryFault.OTHER -> NOT_HELD
            CarryFault.NOT_UPWARD -> NOT_UPWARD
            CarryFault.NOT_FORWARD -> NOT_FORWARD
            CarryFault.NOT_LEVEL -> NOT_LEVEL
        }
    }
}

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
    /** What went wrong last. */
    val mishap: Mishap? = null,
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
    /** No half a walk: its recording says nothing yet of waypoints that are taken back. */
    val canShare get() = phase == Phase.IDLE && (hasMap || nWalks > 0)

    /** The covered part of what is open, in per cent. */
    val coveredPercent: Int
        get() = coverage?.totals?.let { if (it.openM2 > 0) (100 * it.coveredM2 / it.openM2).toInt().coerceAtMost(100) else 0 } ?: 0
}
