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
        @State private var survey: SurveyScreenModel?
        @State private var message: String?

        var body: some View {
            Form {
                Section("Floor") {
                    TextField("Name", text: $floor)
                    Stepper("Number: \(ordinal)", value: $ordinal, in: -20...200)
                }
                Section("UUIDs of the building's iBeacons, one a line; iOS hears no others") {
                    TextEditor(text: $beacons).font(.body.monospaced()).frame(minHeight: 60)
                }
                Button("Choose the floor plan (GeoJSON)…") { isChoosing = true }
                    .disabled(floor.isEmpty)
                if let message { Text(message).foregroundStyle(.red) }
            }
            .navigationTitle("Survey")
            .fileImporter(isPresented: $isChoosing, allowedContentTypes: [.json, .data]) { choice in
                do { try open(choice.get()) } catch { message = error.localizedDescription }
            }
            .navigationDestination(isPresented: Binding(get: { survey != nil }, set: { if !$0 { survey = nil } })) {
                if let survey { SurveyScreen(model: survey) }
            }
        }

        private func open(_ file: URL) throws {
            let isScoped = file.startAccessingSecurityScopedResource()
            defer { if isScoped { file.stopAccessingSecurityScopedResource() } }
            let engine = try SurveyorEngine(plan: Data(contentsOf: file), floor: floor, ordinal: Int32(ordinal))
            let uuids = beacons.split(whereSeparator: \.isWhitespace).compactMap { UUID(uuidString: String($0)) }
            survey = SurveyScreenModel(
                floor: floor, engine: engine, sensors: [MotionSensors(), IbeaconRanging(uuids: uuids)])
            message = nil
        }
    }
#endif
