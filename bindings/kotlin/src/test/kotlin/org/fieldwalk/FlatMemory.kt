package org.fieldwalk

import java.io.File

/**
 * Whether what is done again and again takes no more memory.
 *
 * A leak takes more each time, though by fits and starts. What the JVM compiles and what the allocator keeps comes to an
 * end, when and at how much differs from run to run: so three times in a row are looked for that add little together.
 */
object FlatMemory {
    private const val IN_A_ROW = 3
    const val MOST_TIMES = 9

    /**
     * Does [use] at least [leastTimes] and until [IN_A_ROW] have added less than [limitKb] together; what the process held
     * after each time, in kB.
     */
    fun after(
        limitKb: Long,
        leastTimes: Int = 1,
        residentKb: () -> Long = { ProcessUse.now().residentKb },
        use: (time: Int) -> Unit,
    ): List<Long> {
        val heldKb = mutableListOf<Long>()
        var isFlat = false
        while (heldKb.size < leastTimes || !isFlat) {
            check(heldKb.size < MOST_TIMES) { "memory grows, kB: $heldKb" }
            use(heldKb.size)
            heldKb += residentKb()
            val before = heldKb.getOrNull(heldKb.size - 1 - IN_A_ROW)
            isFlat = isFlat || before != null && heldKb.last() < before + limitKb
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
