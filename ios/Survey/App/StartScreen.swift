#if canImport(SwiftUI) && os(iOS)
    import Fieldwalk
    import FieldwalkSurvey
    import SwiftUI
    import UniformTypeIdentifiers

    /// Which floor is surveyed, on which plan, with which beacons.
    struct StartScreen: View {
        @State private var floor = "F1"
        @State private var ordinal = 0
        @State private var beacons = ""
        @State private var isChoosing = false
        @State private var isReplacing = false
        /// What the survey on the disk is of.
        @State private var kept: SurveyFolder.Floor?
        /// The survey that is open: it outlives its screen.
        @State private var survey: SurveyScreenModel?
        @State private var isSurveying = false
        @State private var message: String?

        var body: some View {
            Form {
                if let kept {
                    Section { Button("Continue the survey of \(kept.name)") { attempt { try resume() } } }
                }
                Section("Floor") {
                    TextField("Name", text: $floor)
                    Stepper("Number: \(ordinal)", value: $ordinal, in: -20...200)
                }
                Section("UUIDs of the building's iBeacons, one a line; iOS hears no others") {
                    TextEditor(text: $beacons).font(.body.monospaced()).frame(minHeight: 60)
                }
                Button("Choose the floor plan (GeoJSON)…") {
                    attempt {
                        _ = try beaconUUIDs(in: beacons)
                        if kept == nil { isChoosing = true } else { isReplacing = true }
                    }
                }
                .disabled(floor.isEmpty)
                .confirmationDialog("Begin a new survey?", isPresented: $isReplacing, titleVisibility: .visible) {
                    Button("Drop the survey of \(kept?.name ?? "")", role: .destructive) { isChoosing = true }
                } message: {
                    Text("Its walks are deleted when the new plan opens. Export its map first.")
                }
                if let message { Text(message).foregroundStyle(.red) }
            }
            .navigationTitle("Survey")
            .fileImporter(isPresented: $isChoosing, allowedContentTypes: [.json, .data]) { choice in
                attempt { try open(choice.get()) }
            }
            .navigationDestination(isPresented: $isSurveying) {
                if let survey { SurveyScreen(model: survey) }
            }
            .onAppear { kept = try? SurveyFolder.ofApp().floor }
        }

        private func open(_ file: URL) throws {
            let isScoped = file.startAccessingSecurityScopedResource()
            defer { if isScoped { file.stopAccessingSecurityScopedResource() } }
            let surveyed = SurveyFolder.Floor(
                name: floor, ordinal: Int32(ordinal), beaconUUIDs: try beaconUUIDs(in: beacons))
            try SurveyFolder.ofApp().create(plan: Data(contentsOf: file), floor: surveyed)
            survey = nil
            try resume()
        }

        /// Goes on with the survey that is open, or that on the disk.
        private func resume() throws {
            if survey == nil {
                let folder = try SurveyFolder.ofApp()
                let engine = try SurveyorEngine(folder: folder)
                let floor = engine.floor
                let beacons = BeaconWatch { report in
                    IbeaconRanging(uuids: floor.beaconUUIDs) { trouble in
                        switch trouble {
                        case .notAuthorized: report(.notAuthorized)
                        case .rangingFailed: report(.rangingFailed)
                        }
                    }
                }
                survey = SurveyScreenModel(
                    floor: floor.name, engine: engine, sensors: [MotionSensors()], beacons: beacons)
            }
            isSurveying = true
        }

        private func attempt(_ step: () throws -> Void) {
            message = nil
            do { try step() } catch { message = error.localizedDescription }
        }
    }
#endif
