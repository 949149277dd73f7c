//! The instruction sets of phones.

/// An instruction set as Android, Rust and clang call it.
#[derive(Debug)]
pub struct Abi {
    /// In an AAR: `jni/NAME/`.
    pub name: &'static str,
    pub rust_target: &'static str,
    pub clang_target: &'static str,
    /// Of a stub library: architecture and width.
    pub stub_arch: &'static str,
    pub bits: u32,
    /// A panic unwinds; otherwise it ends the app. Without an NDK nothing unwinds on 32-bit Arm.
    pub unwinds: bool,
}

/// Emulators are x86-64.
pub const ABIS: [Abi; 3] = [
    Abi {
        name: "arm64-v8a",
        rust_target: "aarch64-linux-android",
        clang_target: "aarch64-linux-android24",
        stub_arch: "AArch64",
        bits: 64,
        unwinds: true,
    },
    Abi {
        name: "armeabi-v7a",
        rust_target: "armv7-linux-androideabi",
        clang_target: "armv7a-linux-androideabi24",
        stub_arch: "ARM",
        bits: 32,
        unwinds: false,
    },
    Abi {
        name: "x86_64",
        rust_target: "x86_64-linux-android",
        clang_target: "x86_64-linux-android24",
        stub_arch: "x86_64",
        bits: 64,
        unwinds: true,
    },
];

/// The oldest Android that the library is linked for; the Kotlin side asks for 8 (26).
pub const API: u32 = 24;

/// What the library calls of Android's own, by library, as of [`API`]. Linking fails when it calls anything else.
pub const IMPORTS: [(&str, &str); 3] = [
    (
        "c",
        "__errno __system_property_get abort calloc close closedir dirfd fcntl fdatasync free fstat fsync getauxval \
         getcwd getenv getpid gettid lseek lseek64 malloc memcmp memcpy memmove memset mkdir mmap munmap open opendir \
         posix_memalign pthread_getspecific pthread_key_create pthread_key_delete pthread_setspecific read readdir \
         readlink realloc realpath rename stat strerror_r strlen syscall unlink write writev \
         __aeabi_memclr __aeabi_memclr4 __aeabi_memclr8 __aeabi_memcpy __aeabi_memcpy4 __aeabi_memcpy8 \
         __aeabi_memmove __aeabi_memmove4 __aeabi_memmove8 __aeabi_memset __aeabi_memset4 __aeabi_memset8",
    ),
    ("dl", "dl_iterate_phdr dlsym"),
    ("m", "sincos"),
];
