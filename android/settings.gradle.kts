// How Android developers build the library and the app. Not run by this repository's checks, which have no Android SDK:
// those build the same sources with Maven (pom.xml).
pluginManagement {
    repositories {
        google()
        mavenCentral()
        gradlePluginPortal()
    }
}
dependencyResolutionManagement {
    repositoriesMode.set(RepositoriesMode.FAIL_ON_PROJECT_REPOS)
    repositories {
        google()
        mavenCentral()
    }
}
rootProject.name = "fieldwalk-android"
include(":fieldwalk", ":survey")
