package org.fieldwalk.survey

import org.fieldwalk.Recorder
import org.fieldwalk.RecordingDetails
import org.fieldwalk.RecordingReader
import org.fieldwalk.Surveyor
import org.fieldwalk.Waypoint
import org.fieldwalk.android.PhoneSensors
import java.io.File
import java.nio.ByteBuffer

/**
 * A survey on disk, so that it outlives the app: the plan, a recording of every walk, and beside each what a recording has
 * no word for, which waypoints were taken back and when the walk stood still.
 */
class SurveyFolder(val folder: File) {
    private val planFile = File(folder, "plan.geojson")
    private val floorFile = File(folder, "floor.txt")
    val mapFile get() = File(folder, "map.tar")

    val isSurvey: Boolean get() = planFile.isFile && floorFile.isFile

    val floor: String get() = floorFile.readLines().first()

    /** Begins anew, with nothing but the plan. */
    fun create(plan: ByteArray, floor: String, ordinal: Int) {
        folder.deleteRecursively()
        folder.mkdirs()
        planFile.writeBytes(plan)
        floorFile.writeText("$floor\n$ordinal\n")
    }

    /** A surveyor of the plan, without a walk. */
    fun surveyor(): Surveyor {
        val (name, ordinal) = floorFile.readLines()
        return Surveyor(planFile.readBytes().toDirect(), name, ordinal.toInt())
    }

    fun recordings(): List<File> =
        folder.listFiles { file -> file.extension == "mcap" }.orEmpty().sortedBy { it.nameWithoutExtension.toInt() }

    /** Records a new walk; the file stands under a number that no other has had. */
    fun beginWalk(): OpenWalk {
        val number = 1 + (recordings().lastOrNull()?.nameWithoutExtension?.toInt() ?: 0)
        val details = RecordingDetails(device = android.os.Build.MODEL ?: "", software = "Fieldwalk survey", floor = floor)
        return OpenWalk(Recorder(walkFile(number).path, details), journal(number))
    }

    fun dropLastWalk() {
        recordings().lastOrNull()?.let(::drop)
    }

    /** Drops a walk that the map cannot use. */
    fun drop(recording: File) {
        recording.delete()
        journal(recording.nameWithoutExtension.toInt()).delete()
    }

    /** Gives what was recorded to [surveyor], whose walk has begun, as it was given at the time. */
    fun replay(recording: File, surveyor: Surveyor) {
        val events = journal(recording.nameWithoutExtension.toInt()).takeIf { it.isFile }?.readLines().orEmpty()
            .map { it.split(' ') }.filter { it.size == 2 }
        val undone = events.filter { it[0] == "undo" }.mapNotNull { it[1].toLongOrNull() }.toSet()
        val pauses = events.filter { it[0] == "pause" }.mapNotNull { it[1].toLongOrNull() }
        var lastNs = Long.MIN_VALUE
        RecordingReader.open(recording.path).use { reader ->
            // A part ends at a waypoint.
            for (part in generateSequence { reader.nextPart(UInt.MAX_VALUE) }) {
                val waypoint = part.waypoint
                val untilNs = waypoint?.timeNs ?: Long.MAX_VALUE
                if (pauses.any { it in lastNs..<untilNs }) {
                    surveyor.pause()
                    surveyor.resume()
                }
                surveyor.pushSamples(part.samples.toDirect())
                if (waypoint != null && waypoint.timeNs !in undone) surveyor.pushWaypoint(waypoint)
                lastNs = untilNs
            }
        }
    }

    private fun walkFile(number: Int) = File(folder, "$number.mcap")

    private fun journal(number: Int) = File(folder, "$number.journal")

    /** A walk that is being recorded; what [PhoneSensors] push goes in whole. */
    class OpenWalk(private val recorder: Recorder, private val journal: File) {
        fun push(batch: ByteBuffer) = recorder.pushSamples(batch)

        fun tap(waypoint: Waypoint) {
            recorder.pushWaypoint(waypoint)
            recorder.flush()
        }

        fun undo(waypoint: Waypoint) = journal.appendText("undo ${waypoint.timeNs}\n")

        fun pause(timeNs: Long) {
            recorder.flush()
            journal.appendText("pause $timeNs\n")
        }

        fun finish() = recorder.use { it.finish() }
    }
}

/** A copy that the engine can read in place. */
internal fun ByteArray.toDirect(): ByteBuffer = ByteBuffer.allocateDirect(size).also {
    it.put(this)
    it.flip()
}
