#if canImport(SwiftUI) && os(iOS)
    import Fieldwalk
    import FieldwalkSurvey
    import SwiftUI

    /// The plan to look at and to tap on: drag, pinch, tap.
    struct PlanCanvas: View {
        let plan: PlanLines
        let state: SurveyState
        let tapped: (Point2) -> Void
        @State private var viewport: PlanViewport?
        @State private var dragged = CGSize.zero
        @State private var pinched = 1.0

        var body: some View {
            GeometryReader { geometry in
                let size = geometry.size
                let shown = current(in: size)
                Canvas { context, _ in draw(into: &context, shown) }
                    .contentShape(Rectangle())
                    .gesture(
                        SpatialTapGesture().onEnded { tap in
                            let spot = PlanViewport.Spot(x: tap.location.x, y: tap.location.y)
                            if let point = shown.point(at: spot) { tapped(point) }
                        }
                    )
                    .simultaneousGesture(
                        DragGesture(minimumDistance: 10)
                            .onChanged { dragged = $0.translation }
                            .onEnded { _ in settle(in: size) }
                    )
                    .simultaneousGesture(
                        MagnificationGesture().onChanged { pinched = $0 }.onEnded { _ in settle(in: size) }
                    )
                    .onChange(of: size) { _ in viewport = nil }
            }
            .background(Color(white: 0.97))
        }

        /// Where the plan lies while fingers move it.
        private func current(in size: CGSize) -> PlanViewport {
            let still = viewport ?? PlanViewport(plan: plan, screenWidth: size.width, screenHeight: size.height)
            return still.zoomed(by: pinched, about: .init(x: size.width / 2, y: size.height / 2))
                .dragged(x: dragged.width, y: dragged.height)
        }

        private func settle(in size: CGSize) {
            viewport = current(in: size)
            (dragged, pinched) = (.zero, 1)
        }

        private func draw(into context: inout GraphicsContext, _ viewport: PlanViewport) {
            func place(_ point: Point2) -> CGPoint {
                let spot = viewport.spot(of: point)
                return CGPoint(x: spot.x, y: spot.y)
            }
            func path(_ points: [Point2], isClosed: Bool) -> Path {
                var path = Path()
                path.addLines(points.map(place))
                if isClosed { path.closeSubpath() }
                return path
            }
            if let image = state.coverage.flatMap(CoverageImage.init), let picture = image.picture {
                // Each pixel has its node in its middle: the image begins half a node before the origin.
                let halfM = image.widthM / Double(image.nColumns) / 2
                let corner = place(Point2(xM: -halfM, yM: image.heightM - halfM))
                let size = CGSize(width: image.widthM * viewport.scale, height: image.heightM * viewport.scale)
                context.draw(Image(decorative: picture, scale: 1), in: CGRect(origin: corner, size: size))
            }
            plan.rings.forEach { context.stroke(path($0, isClosed: true), with: .color(.gray), lineWidth: 1) }
            plan.lines.forEach { context.stroke(path($0, isClosed: false), with: .color(.secondary), lineWidth: 1) }
            context.stroke(path(state.taps, isClosed: false), with: .color(.blue), lineWidth: 3)
            for tap in state.taps.map(place) {
                let dot = CGRect(x: tap.x - 6, y: tap.y - 6, width: 12, height: 12)
                context.fill(Path(ellipseIn: dot), with: .color(.blue))
            }
        }
    }

    extension CoverageImage {
        /// The pixels as an image of Core Graphics.
        fileprivate var picture: CGImage? {
            guard let provider = CGDataProvider(data: Data(rgba) as CFData) else { return nil }
            return CGImage(
                width: nColumns, height: nRows, bitsPerComponent: 8, bitsPerPixel: 32, bytesPerRow: 4 * nColumns,
                space: CGColorSpaceCreateDeviceRGB(),
                bitmapInfo: CGBitmapInfo(rawValue: CGImageAlphaInfo.premultipliedLast.rawValue), provider: provider,
                decode: nil, shouldInterpolate: false, intent: .defaultIntent)
        }
    }
#endif
