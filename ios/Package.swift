// swift-tools-version: 6.0
import PackageDescription

// The engine: on Linux the shared library that `cargo xtask bindings` builds (`swift build -Xlinker -L<folder of
// libfieldwalk_ffi.so>`), on Apple's platforms the framework that scripts/xcframework.sh lays out.
#if os(Linux)
    let engine: Target = .systemLibrary(name: "FieldwalkFFI")
#else
    let engine: Target = .binaryTarget(name: "FieldwalkFFI", path: "FieldwalkFFI.xcframework")
#endif

let package = Package(
    name: "Fieldwalk",
    platforms: [.iOS(.v15), .macOS(.v12)],
    products: [
        .library(name: "Fieldwalk", targets: ["Fieldwalk"]),
        .library(name: "FieldwalkSurvey", targets: ["FieldwalkSurvey"]),
    ],
    targets: [
        engine,
        .target(
            name: "Fieldwalk",
            dependencies: ["FieldwalkFFI"],
            resources: [.copy("PrivacyInfo.xcprivacy")]
        ),
        .testTarget(name: "FieldwalkTests", dependencies: ["Fieldwalk", "FieldwalkSurvey"]),
        // The survey app's logic; the app itself is Survey/project.yml.
        .target(name: "FieldwalkSurvey", dependencies: ["Fieldwalk"], path: "Survey/Model"),
        .testTarget(name: "FieldwalkSurveyTests", dependencies: ["FieldwalkSurvey"], path: "Survey/Tests"),
    ]
)
