//! The way of Kotlin's `SensorLoop` into a positioner: over JNI, without an object made on the way unless there is a fix.
#![allow(
    unsafe_code,
    reason = "JNI gives an address and a length, UniFFI a handle; each use says why it holds"
)]

use std::slice;

use jni::EnvUnowned;
use jni::errors::{Error, Result, ThrowRuntimeExAndDefault};
use jni::objects::{JByteArray, JByteBuffer, JObject};
use jni::sys::{jint, jlong};
use uniffi::{Handle, HandleAlloc, Lower};

use crate::UniFfiTag;
use crate::fix::Fix;
use crate::positioner::Positioner;

/// Pushes the first `n_bytes` bytes of the direct buffer `batch`: gives null when no step was completed, an empty array
/// when the batch was refused, otherwise the fixes as UniFFI packs them.
///
/// `handle` is a positioner's that the caller of this keeps for as long as the call takes.
#[unsafe(no_mangle)]
extern "system" fn Java_org_fieldwalk_SensorLoop_pushOverJni<'local>(
    mut env: EnvUnowned<'local>,
    _this: JObject<'local>,
    handle: jlong,
    batch: JByteBuffer<'local>,
    n_bytes: jint,
) -> JByteArray<'local> {
    let pushed = env.with_env(|env| -> Result<JByteArray<'local>> {
        let n_bytes = usize::try_from(n_bytes).map_err(|_| Error::NullPtr("a negative length"))?;
        if n_bytes > env.get_direct_buffer_capacity(&batch)? {
            return Err(Error::NullPtr("a length beyond the buffer's end"));
        }
        let address = env.get_direct_buffer_address(&batch)?;
        // SAFETY: the JVM keeps the buffer's memory while `batch` is referenced, which is for the whole call, and it is
        // as long as was checked. `SensorLoop` does one call at a time and its batch is for one thread.
        let bytes = unsafe { slice::from_raw_parts(address, n_bytes) };
        let handle = Handle::from_raw_unchecked(handle as u64);
        // SAFETY: `SensorLoop` owns the handle and does not free it while a call is made.
        let positioner = unsafe { <Positioner as HandleAlloc<UniFfiTag>>::get_arc(handle) };
        match positioner.push_samples(bytes) {
            Ok(fixes) if fixes.is_empty() => Ok(JByteArray::null()),
            Ok(fixes) => {
                let mut packed = Vec::new();
                <Vec<Fix> as Lower<UniFfiTag>>::write(fixes, &mut packed);
                env.byte_array_from_slice(&packed)
            }
            // The other way tells what is wrong.
            Err(_refusal) => env.byte_array_from_slice(&[]),
        }
    });
    pushed.resolve::<ThrowRuntimeExAndDefault>()
}
