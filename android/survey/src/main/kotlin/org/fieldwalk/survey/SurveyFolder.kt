package org.fieldwalk.survey

import org.fieldwalk.ApiException
import org.fieldwalk.Recorder
import org.fieldwalk.RecordingDetails
import org.fieldwalk.RecordingReader
import org.fieldwalk.Surveyor
import org.fieldwalk.Waypoint
import org.fieldwalk.android.PhoneSensors
import java.io.File
import java.io.IOException
import java.nio.ByteBuffer
import java.util.Date

/**
 * A survey on disk, so that it outlives the app: the plan, and recordings of every walk, one for each part between pauses,
 * so that no line joins what a pause parts, whoever reads them. Beside a recording stands what it has no word for: which
 * waypoints were taken back.
 *
 * @param record starts a recording in a new file
 */
class SurveyFolder(val folder: File, private val record: (String, RecordingDetails) -> Recorder = ::Recorder) {
    private val planFile = File(folder, "plan.geojson")
    private val floorFile = File(folder, "floor.txt")
    private val sharedFile = File(folder, "shared.txt")
    val mapFile get() = File(folder, "map.tar")

    /** No other survey has it. */
    val name: String get() = folder.name

    val begun: Date get() = Date(floorFile.lastModified())

    val isSurvey: Boolean get() = planFile.isFile && floorFile.isFile

    val floor: String get() = floorFile.readLines().first()

    private val ordinal: Int get() = floorFile.readLines()[1].toInt()

    /** Begins with nothing but the plan. */
    fun create(plan: ByteArray, floor: String, ordinal: Int) {
        try {
            if (!folder.mkdirs()) throw IOException("the folder cannot be made")
            planFile.writeBytes(plan)
            // Half a survey is none: this file makes it one.
            val whole = File(folder, "floor.part")
            whole.writeText("$floor\n$ordinal\n")
            if (!whole.renameTo(floorFile)) throw IOException("the floor cannot be put into its place")
        } catch (refused: IOException) {
            folder.deleteRecursively()
            throw refused
        }
    }

    /** A surveyor of the plan, without a walk. */
    fun surveyor(): Surveyor = Surveyor(planFile.readBytes().toDirect(), floor, ordinal)

    /** What leaves the phone: the map, the recordings, and those that were put aside. */
    fun toShare(): List<File> = listOf(mapFile).filter { it.isFile } + recordings() + aside()

    /** Notes that what there is now was given away. */
    fun noteShared() = sharedFile.writeText(listing())

    /** Whether nothing has changed since it was given away. */
    val isShared: Boolean get() = sharedFile.isFile && sharedFile.readText() == listing()

    private fun listing() = toShare().joinToString("\n") { "${it.name} ${it.length()} ${it.lastModified()}" }

    /** The parts of every walk, in order. */
    fun walks(): List<List<File>> = recordings().groupBy(::number).values.toList()

    fun recordings(): List<File> =
        folder.listFiles { file -> file.extension == "mcap" }.orEmpty().sortedWith(compareBy(::number, ::part))

    /** Recordings that could not be given to the surveyor, kept for whoever can make something of them. */
    fun aside(): List<File> =
        folder.listFiles { file -> file.name.endsWith(".mcap$ASIDE") }.orEmpty().sortedBy { it.name }

    /** Records the first part of a new walk, under a number that no other has. */
    // What was put aside, and a journal left behind, keep theirs.
    fun beginWalk(): OpenPart = begin(1 + (folder.listFiles().orEmpty().maxOfOrNull(::number) ?: 0), 1)

    /** Records the part after [recording]. */
    fun beginPart(recording: File): OpenPart = begin(number(recording), part(recording) + 1)

    private fun begin(number: Int, part: Int): OpenPart {
        val recording = File(folder, "$number-$part.mcap")
        // Readers take the floor's number from its name in a recording: one that contradicts the map's is left out.
        val name = floor.takeIf { floorOrdinal(it) == ordinal }.orEmpty()
        val device = android.os.Build.MODEL ?: ""
        val details = RecordingDetails(device = device, software = "Fieldwalk survey", floor = name)
        return try {
            OpenPart(recording, record(recording.path, details), journal(recording))
        } catch (refused: ApiException) {
            // A disk that is full takes the file's name and not its head.
            if (refused !is ApiException.FileExists) recording.delete()
            throw refused
        }
    }

    fun dropLastWalk() {
        walks().lastOrNull()?.forEach(::drop)
    }

    /** Drops what the map cannot use. */
    fun drop(recording: File) {
        recording.delete()
        journal(recording).delete()
    }

    /** Takes a recording out of the survey and keeps it, unless nothing was ever written into it; tells whether it is kept. */
    fun putAside(recording: File): Boolean {
        if (isEmpty(recording)) {
            drop(recording)
            return false
        }
        for (file in listOf(recording, journal(recording)).filter { it.isFile }) {
            if (!file.renameTo(File("${file.path}$ASIDE"))) throw IOException("${file.name} cannot be put aside")
        }
        return true
    }

    /** Whether a recording was cut before its first second: no larger than its head, and without a record. */
    private fun isEmpty(recording: File): Boolean = recording.length() < HEAD_BYTES && try {
        RecordingReader.open(recording.path).use { it.nextPart(1u) == null }
    } catch (refused: ApiException) {
        refused is ApiException.RecordingMalformed
    }

    /** Gives what was recorded to [surveyor], whose walk has begun, as it was given at the time. */
    fun replay(recording: File, surveyor: Surveyor) {
        val undone = undone(recording)
        RecordingReader.open(recording.path).use { reader ->
            for (part in reader.parts()) {
                surveyor.pushSamples(part.samples.toDirect())
                part.waypoint?.takeIf { it.timeNs !in undone }?.let(surveyor::pushWaypoint)
            }
        }
    }

    /** Leaves the waypoints that were taken back out of the recordings, which leave the phone without their journals. */
    fun leaveOutUndone() = recordings().forEach { recording ->
        val undone = undone(recording)
        if (undone.isNotEmpty()) {
            val clean = File(folder, "clean.part")
            clean.delete()
            RecordingReader.open(recording.path).use { reader ->
                // Known with the first part, and that is there: a waypoint was taken back.
                val parts = reader.parts().iterator()
                if (!parts.hasNext()) return@forEach
                record(clean.path, reader.details()).use { copy ->
                    for (part in parts) {
                        copy.pushSamples(part.samples.toDirect())
                        part.waypoint?.takeIf { it.timeNs !in undone }?.let(copy::pushWaypoint)
                    }
                    copy.finish()
                }
            }
            if (!clean.renameTo(recording)) throw IOException("${recording.name} cannot be replaced")
        }
        journal(recording).delete()
    }

    private fun undone(recording: File): Set<Long> = journal(recording).takeIf { it.isFile }?.readLines().orEmpty()
        .map { it.split(' ') }.filter { it.size == 2 && it[0] == "undo" }.mapNotNull { it[1].toLongOrNull() }.toSet()

    /** A part ends at a waypoint. */
    private fun RecordingReader.parts() = generateSequence { nextPart(UInt.MAX_VALUE) }

    private fun number(file: File) = file.name.substringBefore('-').toIntOrNull() ?: 0

    private fun part(recording: File) = recording.nameWithoutExtension.substringAfter('-').toInt()

    private fun journal(recording: File) = File(folder, "${recording.nameWithoutExtension}.journal")

    /** A part of a walk that is being recorded; what [PhoneSensors] push goes in whole. */
    class OpenPart(val recording: File, private val recorder: Recorder, private val journal: File) {
        fun push(batch: ByteBuffer) = recorder.pushSamples(batch)

        fun tap(waypoint: Waypoint) {
            recorder.pushWaypoint(waypoint)
            recorder.flush()
        }

        /** A line by itself, whatever a disk that was full has left of the one before. */
        fun undo(waypoint: Waypoint) = journal.appendText("\nundo ${waypoint.timeNs}\n")

        fun flush() = recorder.flush()

        fun finish() = recorder.use { it.finish() }
    }

    private companion object {
        const val ASIDE = ".bad"
        /** More than what a recording holds before its first chunk. */
        const val HEAD_BYTES = 4096L
    }
}

/** A copy that the engine can read in place. */
internal fun ByteArray.toDirect(): ByteBuffer = ByteBuffer.allocateDirect(size).also {
    it.put(this)
    it.flip()
}
