package org.fieldwalk

import com.sun.jna.NativeLibrary
import java.nio.ByteBuffer

/**
 * Pushes samples into a positioner without making garbage: for the loop that sensors call hundreds of times a second.
 *
 * It does what [Positioner.pushSamples] does, to the same bits, over JNI in place of JNA. The positioner stays usable
 * beside it and outlives it; it outlives the positioner's `close`. May be called from any thread: one call is made at a
 * time, a second one waits.
 *
 * The library must be built with the feature `jni`; [isSupported] tells.
 */
public class SensorLoop(positioner: Positioner) : AutoCloseable {
    private val handle = positioner.uniffiCloneHandle()

    /** Owns the handle. */
    private val positioner = FfiConverterTypePositioner.lift(handle)
    private var isClosed = false

    /**
     * Takes the samples of [batch] in and gives a fix for every step that they complete, in order of time. The batch is
     * left as it is: clear it.
     *
     * @throws ApiException when the positioner is broken; see [Positioner.pushSamples]
     * @throws IllegalStateException after [close]
     */
    @Throws(ApiException::class)
    @Synchronized
    public fun push(batch: SampleBatch): List<Fix> {
        check(!isClosed) { "this SensorLoop has been closed" }
        val bytes = batch.written()
        val packed = pushOverJni(handle, bytes, bytes.position()) ?: return emptyList()
        // Refused: nothing was taken in, and the other way says why.
        if (packed.isEmpty()) return positioner.pushSamples(batch.bytes())
        return FfiConverterSequenceTypeFix.read(ByteBuffer.wrap(packed))
    }

    /** Frees what it holds; a second time does nothing. */
    @Synchronized
    override fun close() {
        isClosed = true
        positioner.close()
    }

    private external fun pushOverJni(handle: Long, batch: ByteBuffer, nBytes: Int): ByteArray?

    companion object {
        /** Whether the library was built with the feature `jni`. */
        @JvmStatic
        public val isSupported: Boolean = try {
            // The one that JNA has loaded: the two share its objects.
            val library = NativeLibrary.getInstance("fieldwalk_ffi")
            val file = library.file
            if (file != null && file.isAbsolute) System.load(file.path) else System.loadLibrary("fieldwalk_ffi")
            library.getFunction("Java_org_fieldwalk_SensorLoop_pushOverJni")
            true
        } catch (_: UnsatisfiedLinkError) {
            false
        }
    }
}
