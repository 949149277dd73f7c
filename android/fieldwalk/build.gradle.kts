plugins {
    id("com.android.library")
    id("org.jetbrains.kotlin.android")
}

val engine = rootDir.parentFile
val made = engine.resolve("target/android")

android {
    namespace = "org.fieldwalk.android"
    compileSdk = 36
    defaultConfig {
        minSdk = 26
        consumerProguardFiles("consumer-rules.pro")
    }
    compileOptions {
        sourceCompatibility = JavaVersion.VERSION_17
        targetCompatibility = JavaVersion.VERSION_17
    }
    sourceSets["main"].apply {
        kotlin.srcDir(engine.resolve("target/bindings/kotlin"))
        kotlin.srcDir(engine.resolve("bindings/kotlin/src/main/kotlin"))
        jniLibs.srcDir(made.resolve("jni"))
    }
}

kotlin {
    compilerOptions {
        jvmTarget.set(org.jetbrains.kotlin.gradle.dsl.JvmTarget.JVM_17)
        allWarningsAsErrors.set(true)
    }
}

// The engine for every instruction set, by cargo-ndk with the NDK, and the generated Kotlin.
val bindings by tasks.registering(Exec::class) {
    workingDir = engine
    commandLine("cargo", "xtask", "bindings")
}
val nativeLibraries by tasks.registering(Exec::class) {
    dependsOn(bindings)
    workingDir = engine
    commandLine("cargo", "xtask", "android", "--json")
}
tasks.named("preBuild") { dependsOn(nativeLibraries) }

dependencies {
    api("org.jetbrains.kotlinx:kotlinx-coroutines-android:1.11.0")
    implementation("net.java.dev.jna:jna:5.18.1@aar")
}
