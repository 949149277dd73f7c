#if canImport(SwiftUI) && os(iOS)
    import SwiftUI

    @main
    struct SurveyApp: App {
        var body: some Scene {
            WindowGroup {
                NavigationStack { StartScreen() }
            }
        }
    }
#endif
