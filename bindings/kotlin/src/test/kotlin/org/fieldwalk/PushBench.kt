package org.fieldwalk

import com.sun.management.OperatingSystemMXBean
import org.junit.jupiter.api.Test
import java.io.File
import java.lang.management.ManagementFactory
import java.util.Locale
import java.util.concurrent.locks.LockSupport

/**
 * What pushing samples costs on the JVM, as tables; run by `cargo xtask bench-jvm`, never by the tests.
 *
 * Four sensors at 200 Hz, paced as a phone delivers them. Ways take turns in parts of five seconds, so that whatever else
 * the machine does falls on all of them, and every one is stated as its difference to a loop that does nothing at each tick.
 */
class PushBench {
    private val machine = ManagementFactory.getOperatingSystemMXBean() as OperatingSystemMXBean
    private val threads = ManagementFactory.getThreadMXBean() as com.sun.management.ThreadMXBean
    private val trace = Trace.ofWalk()
    private val lines = mutableListOf<String>()

    @Test
    fun bench() = Walk.openMap().use { map ->
        say("${System.getProperty("java.vm.name")} ${System.getProperty("java.version")}, ${Runtime.getRuntime().availableProcessors()} cores")
        say("")
        // What is called often is compiled before anything is measured.
        Way.entries.forEach { way -> repeat(3) { Pushed(map, way).use { it.pushAll() } } }
        paced(map)
        say("")
        calls(map)
        System.getProperty("fieldwalk.bench")?.let { File(it).writeText(lines.joinToString("\n", postfix = "\n")) }
        Unit
    }

    /** In which way samples cross, and how many ticks of four samples with one call. */
    private enum class Way(val title: String, val ticks: Int, val path: Path) {
        IDLE("nothing (idle)", 1, Path.NOWHERE),
        ENCODE("encoded, pushed nowhere", 10, Path.NOWHERE),
        UNIFFI_BATCH("UniFFI, a batch in 50 ms", 10, Path.UNIFFI),
        JNI_BATCH("JNI, a batch in 50 ms", 10, Path.JNI),
        UNIFFI_TICK("UniFFI, a batch in 5 ms", 1, Path.UNIFFI),
        JNI_TICK("JNI, a batch in 5 ms", 1, Path.JNI),
        UNIFFI_SAMPLE("UniFFI, every sample by itself", 0, Path.UNIFFI),
        JNI_SAMPLE("JNI, every sample by itself", 0, Path.JNI),
    }

    private enum class Path { NOWHERE, UNIFFI, JNI }

    /** One way with its own positioner, at some tick of the walk. */
    private inner class Pushed(map: BuildingMap, val way: Way) : AutoCloseable {
        private val positioner = Positioner(map, 0).also { it.hint(Walk.hint) }
        private val loop = SensorLoop(positioner)
        private val batch = SampleBatch()
        private var tick = 0
        var nFixes = 0
        var sum = Use()

        fun pushTick() {
            val now = tick++ % trace.nTicks
            if (way == Way.IDLE) return
            for (sensor in 0 until N_SENSORS) {
                trace.addTo(batch, now, sensor)
                if (way.ticks == 0) push()
            }
            if (way.ticks > 0 && tick % way.ticks == 0) push()
        }

        private fun push() {
            when (way.path) {
                Path.NOWHERE -> {}
                Path.UNIFFI -> nFixes += positioner.pushSamples(batch.bytes()).size
                Path.JNI -> nFixes += loop.push(batch).size
            }
            batch.clear()
        }

        fun pushAll() = repeat(trace.nTicks) { pushTick() }

        override fun close() {
            loop.close()
            positioner.close()
        }
    }

    private fun paced(map: BuildingMap) {
        val ways = Way.entries.map { Pushed(map, it) }
        // Once as they are measured: what is compiled for a loop without pauses may be compiled anew for one with them.
        ways.forEach { part(it) }
        settle()
        ways.forEach { it.nFixes = 0 }
        // Each begins as often as any other, and each follows another one.
        repeat(N_PARTS) { part -> ways.indices.forEach { k -> ways[(k + part) % ways.size].let { it.sum += part(it) } } }
        val seconds = N_PARTS * PART_TICKS / RATE_HZ
        val idle = ways.first().sum
        say("Paced: 4 sensors at ${RATE_HZ.toInt()} Hz for ${seconds.toInt()} s a way, taking turns.")
        say("")
        say("| | CPU of the process above idle, % of a core | of the caller alone | garbage above idle, kB/s | fixes |")
        say("|---|---:|---:|---:|---:|")
        for (way in ways) {
            val above = if (way.way == Way.IDLE) way.sum else way.sum - idle
            val title = if (way.way == Way.IDLE) "nothing: idle itself" else way.way.title
            say(
                "| $title | ${number(above.processNs / seconds / 1e7)} | ${number(above.threadNs / seconds / 1e7)} " +
                    "| ${number(above.nBytes / seconds / 1e3)} | ${way.nFixes} |",
            )
        }
        ways.forEach { it.close() }
    }

    /** Waits until the compiler and the collector have nothing left to do, a minute at most. */
    private fun settle() {
        System.gc()
        repeat(30) {
            val before = now().processNs
            Thread.sleep(2_000)
            if (now().processNs - before < 20e6) return
        }
    }

    /** Ticks on time for one part. */
    private fun part(pushed: Pushed): Use {
        val before = now()
        var next = System.nanoTime()
        repeat(PART_TICKS) {
            next += (1e9 / RATE_HZ).toLong()
            while (true) {
                val left = next - System.nanoTime()
                if (left <= 0) break
                LockSupport.parkNanos(left)
            }
            pushed.pushTick()
        }
        return now() - before
    }

    private fun calls(map: BuildingMap) {
        say("By the call: the same samples again, which the engine refuses, so that little but the way there is left.")
        say("")
        say("| | UniFFI: CPU, µs | garbage, bytes | JNI: CPU, µs | garbage, bytes | CPU, UniFFI by JNI |")
        say("|---|---:|---:|---:|---:|---:|")
        Positioner(map, 0).use { positioner ->
            SensorLoop(positioner).use { loop ->
                positioner.hint(Walk.hint)
                for (nSamples in listOf(0, 4, 40, 400)) {
                    val batch = SampleBatch()
                    repeat(nSamples) { trace.addTo(batch, it / N_SENSORS, it % N_SENSORS) }
                    val (uniffi, jni) = pair({ positioner.pushSamples(batch.bytes()) }, { loop.push(batch) })
                    say(
                        "| a batch of $nSamples samples | ${number(uniffi.first)} | ${number(uniffi.second)} " +
                            "| ${number(jni.first)} | ${number(jni.second)} | ${number(uniffi.first / jni.first)} |",
                    )
                }
                val (fix, _) = pair({ positioner.fix() }, {})
                say("| `fix()` | ${number(fix.first)} | ${number(fix.second)} | | | |")
            }
        }
    }

    /** Medians of µs and bytes a call, of two that take turns. */
    private fun pair(a: () -> Unit, b: () -> Unit): Pair<Pair<Double, Double>, Pair<Double, Double>> {
        val uses = List(2) { mutableListOf<Use>() }
        repeat(N_TURNS + 2) { turn ->
            listOf(a, b).forEachIndexed { k, call ->
                val before = now()
                repeat(N_CALLS) { call() }
                // The first two warm up.
                if (turn >= 2) uses[k] += now() - before
            }
        }
        fun median(of: List<Use>, value: (Use) -> Double) = of.map(value).sorted()[of.size / 2] / N_CALLS
        val (first, second) = uses.map { of -> median(of) { it.threadNs / 1e3 } to median(of) { it.nBytes } }
        return first to second
    }

    private fun now() = Use(
        machine.processCpuTime.toDouble(), threads.currentThreadCpuTime.toDouble(),
        threads.getThreadAllocatedBytes(Thread.currentThread().id).toDouble(),
    )

    private data class Use(val processNs: Double = 0.0, val threadNs: Double = 0.0, val nBytes: Double = 0.0)

    private operator fun Use.minus(o: Use) = Use(processNs - o.processNs, threadNs - o.threadNs, nBytes - o.nBytes)
    private operator fun Use.plus(o: Use) = Use(processNs + o.processNs, threadNs + o.threadNs, nBytes + o.nBytes)

    private fun say(line: String) {
        println(line)
        lines += line
    }

    private fun number(x: Double) = String.format(Locale.ROOT, if (Math.abs(x) < 10) "%.2f" else "%.0f", x)

    /** The simulated walk at 200 Hz: force, rate, field and pressure at every tick. */
    private class Trace(private val values: Array<FloatArray>, private val beginNs: Long) {
        val nTicks = values.size

        fun addTo(batch: SampleBatch, tick: Int, sensor: Int) {
            val v = values[tick]
            val timeNs = beginNs + (tick * (1e9 / RATE_HZ)).toLong()
            when (sensor) {
                0 -> batch.angularRate(timeNs, v[0], v[1], v[2])
                1 -> batch.specificForce(timeNs, v[3], v[4], v[5])
                2 -> batch.uncalibratedMagneticField(timeNs, v[6], v[7], v[8], v[9], v[10], v[11])
                else -> batch.pressure(timeNs, v[12])
            }
        }

        companion object {
            private val sensors =
                listOf("angular_rate" to 3, "specific_force" to 3, "uncalibrated_magnetic_field" to 6, "pressure" to 1)

            /** Each sensor's last sample is held until the next. */
            fun ofWalk(): Trace {
                val beginNs = Walk.samples.first().timeNs
                val nTicks = ((Walk.samples.last().timeNs - beginNs) / 1e9 * RATE_HZ).toInt()
                val columns = sensors.flatMap { (kind, n) ->
                    val records = Walk.samples.filter { it.kind == kind }
                    val times = records.map { it.timeNs }
                    List(n) { k ->
                        FloatArray(nTicks) { tick ->
                            val at = times.binarySearch(beginNs + (tick * (1e9 / RATE_HZ)).toLong())
                            records[(if (at >= 0) at else -at - 2).coerceAtLeast(0)].float(2 + k)
                        }
                    }
                }
                return Trace(Array(nTicks) { tick -> FloatArray(columns.size) { columns[it][tick] } }, beginNs)
            }
        }
    }

    private companion object {
        const val RATE_HZ = 200.0
        const val N_SENSORS = 4

        /** Five seconds. */
        const val PART_TICKS = 1_000
        const val N_PARTS = 4
        const val N_CALLS = 2_000
        const val N_TURNS = 15
    }
}
