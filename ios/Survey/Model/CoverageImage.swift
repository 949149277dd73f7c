import Foundation

/// A coverage grid as an image to lay over the plan: a pixel a node, the highest y in the first row.
public struct CoverageImage: Sendable, Equatable {
    public let nColumns: Int
    public let nRows: Int
    /// Red, green, blue, opacity, a byte each; colours are multiplied by the opacity.
    public let rgba: [UInt8]
    /// The image's extent on the plan, in metres: each pixel has its node in its middle.
    public let widthM: Double
    public let heightM: Double

    /// Nothing when the grid holds another number of nodes than it says.
    public init?(_ grid: CoverageGrid) {
        guard grid.nColumns > 0, grid.nRows > 0, grid.nodes.count == grid.nColumns * grid.nRows else { return nil }
        (nColumns, nRows) = (grid.nColumns, grid.nRows)
        (widthM, heightM) = (grid.cellM * Double(nColumns), grid.cellM * Double(nRows))
        var rgba: [UInt8] = []
        rgba.reserveCapacity(4 * grid.nodes.count)
        for row in (0..<nRows).reversed() {
            for node in grid.nodes[row * nColumns..<(row + 1) * nColumns] {
                rgba += Self.colour(of: node)
            }
        }
        self.rgba = rgba
    }

    private static func colour(of node: UInt8) -> [UInt8] {
        switch node {
        case 1: [64, 40, 0, 64]
        case 2: [0, 64, 48, 96]
        default: [0, 0, 0, 0]
        }
    }
}

/// The name of the exported file: of the floor, with nothing that a file system or a colleague would stumble over.
public func exportName(floor: String) -> String {
    let plain = floor.map { $0.isASCII && ($0.isLetter || $0.isNumber) ? $0 : "-" }
    let words = String(plain).split(separator: "-").joined(separator: "-")
    return "\(words.isEmpty ? "floor" : words).map.tar"
}
