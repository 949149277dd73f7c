package org.fieldwalk

import java.io.File

/**
 * Whether what is done again and again takes no more memory.
 *
 * A leak takes more each time. What the JVM compiles and what the allocator keeps comes to an end, when and at how much
 * differs from run to run: so there need be one time only that adds nothing to the most that was held before.
 */
object FlatMemory {
    private const val MOST_TIMES = 8

    /**
     * Does [use] at least [leastTimes] and until it adds less than [stepKb] to the most that the process has held; what it
     * held after each time, in kB.
     */
    fun after(
        stepKb: Long,
        leastTimes: Int = 2,
        residentKb: () -> Long = { ProcessUse.now().residentKb },
        use: (time: Int) -> Unit,
    ): List<Long> {
        val heldKb = mutableListOf<Long>()
        var isFlat = false
        while (heldKb.size < leastTimes || !isFlat) {
            check(heldKb.size < MOST_TIMES) { "memory grows each time, kB: $heldKb" }
            use(heldKb.size)
            val nowKb = residentKb()
            isFlat = isFlat || heldKb.isNotEmpty() && nowKb < heldKb.max() + stepKb
            heldKb += nowKb
        }
        return heldKb
    }
}

/** What the process holds; of its memory the Java heap is fixed in size by the POM. */
data class ProcessUse(val residentKb: Long, val nThreads: Int, val nFiles: Int) {
    companion object {
        /** Garbage is collected first. Zeros where there is no /proc. */
        fun now(): ProcessUse {
            repeat(3) {
                System.gc()
                Thread.sleep(50)
            }
            val lines = File("/proc/self/status").takeIf { it.exists() }?.readLines() ?: return ProcessUse(0, 0, 0)
            fun number(name: String) = lines.first { it.startsWith("$name:") }.split(Regex("\\s+"))[1].toLong()
            return ProcessUse(number("VmRSS"), number("Threads").toInt(), File("/proc/self/fd").list()!!.size)
        }
    }
}
