#if canImport(SwiftUI) && os(iOS)
    import Fieldwalk
    import FieldwalkSurvey
    import SwiftUI

    /// What the survey's screen shows; all that it decides is in `SurveyWalks`.
    @MainActor
    final class SurveyScreenModel: ObservableObject {
        @Published private(set) var state = SurveyState()
        @Published private(set) var built: BuiltMap?
        let floor: String
        let plan: PlanLines
        private let walks: SurveyWalks

        init(floor: String, engine: any SurveyEngine, sensors: [any SensorSource], beacons: BeaconWatch) {
            self.floor = floor
            plan = engine.plan()
            walks = SurveyWalks(engine: engine, sensors: sensors, beacons: beacons)
        }

        /// Looks twice a second, until the screen goes.
        func watch() async {
            while !Task.isCancelled {
                state = await walks.look()
                try? await Task.sleep(nanoseconds: 500_000_000)
            }
        }

        func tell(_ step: @escaping @Sendable (isolated SurveyWalks) -> Void) {
            Task {
                await step(walks)
                state = await walks.look()
            }
        }

        func build() {
            Task {
                built = await walks.build()
                state = await walks.look()
            }
        }
    }
#endif
