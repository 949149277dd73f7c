//! The way of Kotlin's `SensorLoop` into a positioner: over JNI, without an object made on the way unless there is a fix.
//!
//! The JVM's table of functions is called directly: what the crate `jni` puts round it costs a phone 90 kB.
#![allow(
    unsafe_code,
    reason = "JNI gives an address and a length, UniFFI a handle; each use says why it holds"
)]

use std::ffi::CStr;
use std::{panic, ptr, slice};

use jni::sys::{JNIEnv, jbyteArray, jint, jlong, jobject};
use uniffi::{Handle, HandleAlloc, Lower};

use crate::UniFfiTag;
use crate::fix::Fix;
use crate::positioner::Positioner;

/// Pushes the first `n_bytes` bytes of the direct buffer `batch`: gives null when no step was completed, an empty array
/// when the batch was refused, otherwise the fixes as UniFFI packs them.
///
/// `handle` is a positioner's that the caller of this keeps for as long as the call takes.
#[unsafe(no_mangle)]
extern "system" fn Java_org_fieldwalk_SensorLoop_pushOverJni(
    env: *mut JNIEnv,
    _this: jobject,
    handle: jlong,
    batch: jobject,
    n_bytes: jint,
) -> jbyteArray {
    // SAFETY: the JVM calls this with its environment of this thread, and keeps `batch` for the whole call. A panic must
    // not pass into it.
    let packed = panic::catch_unwind(|| unsafe { push(env, handle, batch, n_bytes) });
    // SAFETY: as above.
    unsafe {
        match packed.unwrap_or(Err(c"the engine has failed")) {
            Ok(None) => ptr::null_mut(),
            Ok(Some(packed)) => byte_array(env, &packed),
            Err(reason) => {
                throw(env, reason);
                ptr::null_mut()
            }
        }
    }
}

/// The fixes packed, nothing where there are none; or what is wrong with the call.
///
/// # Safety
/// `env` is this thread's, `batch` an object's or null, `handle` a positioner's.
unsafe fn push(
    env: *mut JNIEnv,
    handle: jlong,
    batch: jobject,
    n_bytes: jint,
) -> Result<Option<Vec<u8>>, &'static CStr> {
    if batch.is_null() {
        return Err(c"no batch");
    }
    // SAFETY: both functions are JNI's since 1.4, and bear any buffer.
    let (address, capacity) = unsafe {
        let functions = &(**env).v1_4;
        ((functions.GetDirectBufferAddress)(env, batch), (functions.GetDirectBufferCapacity)(env, batch))
    };
    if address.is_null() {
        return Err(c"the batch is in no direct buffer");
    }
    let n_bytes = usize::try_from(n_bytes).map_err(|_| c"a negative length")?;
    if usize::try_from(capacity).map_or(true, |capacity| n_bytes > capacity) {
        return Err(c"a length beyond the buffer's end");
    }
    // SAFETY: the JVM keeps the buffer's memory while `batch` is referenced, which is for the whole call, and it is as long
    // as was checked. `SensorLoop` does one call at a time and its batch is for one thread.
    let bytes = unsafe { slice::from_raw_parts(address.cast::<u8>(), n_bytes) };
    let handle = Handle::from_raw_unchecked(handle as u64);
    // SAFETY: `SensorLoop` owns the handle and does not free it while a call is made.
    let positioner = unsafe { <Positioner as HandleAlloc<UniFfiTag>>::get_arc(handle) };
    Ok(match positioner.push_samples(bytes) {
        Ok(fixes) if fixes.is_empty() => None,
        Ok(fixes) => {
            let mut packed = Vec::new();
            <Vec<Fix> as Lower<UniFfiTag>>::write(fixes, &mut packed);
            Some(packed)
        }
        // The other way tells what is wrong.
        Err(_refusal) => Some(Vec::new()),
    })
}

/// `bytes` as an array of Java's; null where there is no room, of which the JVM then throws.
///
/// # Safety
/// `env` is this thread's.
unsafe fn byte_array(env: *mut JNIEnv, bytes: &[u8]) -> jbyteArray {
    let Ok(n_bytes) = jint::try_from(bytes.len()) else { return ptr::null_mut() };
    // SAFETY: JNI's since 1.1; what is copied is as long as the array.
    unsafe {
        let functions = &(**env).v1_1;
        let array = (functions.NewByteArray)(env, n_bytes);
        if !array.is_null() {
            (functions.SetByteArrayRegion)(env, array, 0, n_bytes, bytes.as_ptr().cast());
        }
        array
    }
}

/// Has the JVM throw when the call returns.
///
/// # Safety
/// `env` is this thread's.
unsafe fn throw(env: *mut JNIEnv, reason: &CStr) {
    // SAFETY: JNI's since 1.1. Where the class is missing the JVM throws that.
    unsafe {
        let functions = &(**env).v1_1;
        let class = (functions.FindClass)(env, c"java/lang/RuntimeException".as_ptr());
        if !class.is_null() {
            (functions.ThrowNew)(env, class, reason.as_ptr());
        }
    }
}
