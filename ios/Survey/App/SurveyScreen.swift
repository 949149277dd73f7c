#if canImport(SwiftUI) && os(iOS)
    import FieldwalkSurvey
    import SwiftUI
    import UIKit
    import UniformTypeIdentifiers

    /// The plan with what is covered, and the buttons of the walk.
    struct SurveyScreen: View {
        @ObservedObject var model: SurveyScreenModel
        @State private var isExporting = false
        @State private var isLeaving = false
        @Environment(\.dismiss) private var dismiss

        var body: some View {
            VStack(spacing: 8) {
                PlanCanvas(plan: model.plan, state: model.state) { point in model.tell { $0.tap(point) } }
                Text(model.state.summary).font(.headline)
                Text(model.state.message ?? model.state.advice)
                    .foregroundStyle(model.state.message == nil ? Color.secondary : Color.red)
                if model.state.canEnd { Text("\(model.state.nSteps) steps").monospacedDigit() }
                ForEach(model.state.remedies, id: \.self) { Text($0).foregroundStyle(.orange) }
                walkButtons
                mapButtons
            }
            .padding()
            .navigationTitle(model.floor)
            // Without the button there is no swipe either.
            .navigationBarBackButtonHidden(model.state.isPausedToLeave)
            .toolbar {
                if model.state.isPausedToLeave {
                    ToolbarItem(placement: .navigationBarLeading) { Button("Leave…") { isLeaving = true } }
                }
            }
            .confirmationDialog("Leave the survey?", isPresented: $isLeaving, titleVisibility: .visible) {
                Button("Pause the walk and leave") {
                    model.tell { $0.pause() }
                    dismiss()
                }
            } message: {
                Text("A walk is on. The start screen continues the survey.")
            }
            .task { await model.watch() }
            // A screen that locks suspends the app in the middle of a walk.
            .onAppear { UIApplication.shared.isIdleTimerDisabled = true }
            .onDisappear { UIApplication.shared.isIdleTimerDisabled = false }
            .fileExporter(
                isPresented: $isExporting, document: model.built.map { MapFile(bytes: $0.file) },
                contentType: .data, defaultFilename: exportName(floor: model.floor)
            ) { _ in }
        }

        private var walkButtons: some View {
            HStack {
                if model.state.canBegin { Button("Begin a walk") { model.tell { $0.beginWalk() } } }
                if model.state.canPause { Button("Pause") { model.tell { $0.pause() } } }
                if model.state.canResume { Button("Resume") { model.tell { $0.resume() } } }
                if model.state.canEnd {
                    Button("Undo tap") { model.tell { $0.undoTap() } }.disabled(!model.state.canUndoTap)
                    Button("End the walk") { model.tell { $0.endWalk() } }
                }
            }
            .buttonStyle(.borderedProminent)
        }

        private var mapButtons: some View {
            HStack {
                Button("Undo walk") { model.tell { $0.undoWalk() } }.disabled(!model.state.canUndoWalk)
                Button("Build the map") { model.build() }.disabled(!model.state.canBuild)
                if let built = model.built {
                    Button("Export…") { isExporting = true }
                    if let medianM = built.expectedMedianM {
                        Text("expected error \(medianM, specifier: "%.1f") m")
                    }
                }
            }
            .buttonStyle(.bordered)
        }
    }

    /// The map as one file, to save or to share.
    struct MapFile: FileDocument {
        static let readableContentTypes: [UTType] = [.data]
        let bytes: Data

        init(bytes: Data) { self.bytes = bytes }
        init(configuration: ReadConfiguration) throws { bytes = configuration.file.regularFileContents ?? Data() }

        func fileWrapper(configuration: WriteConfiguration) -> FileWrapper {
            FileWrapper(regularFileWithContents: bytes)
        }
    }
#endif
