import Foundation
import Testing

@testable import FieldwalkSurvey

struct BeaconsTests {
    @Test func aLineIsAUUIDOrItIsTold() throws {
        let (one, other) = ("E2C56DB5-DFFB-48D2-B060-D0F5A71096E0", "2F234454-CF6D-4A0F-ADF2-F4911BA9FFA6")
        #expect(try beaconUUIDs(in: " \n\n") == [])
        #expect(try beaconUUIDs(in: " \(one.lowercased()) \r\n\(other)") == [one, other].map { UUID(uuidString: $0) })
        let cut = String(one.dropLast())
        #expect(throws: NoUUIDs(lines: [cut, "\(one) \(other)"])) {
            try beaconUUIDs(in: "\(other)\n\(cut)\n\(one) \(other)")
        }
        #expect(NoUUIDs(lines: [cut]).localizedDescription.contains("“\(cut)”"))
    }
}
