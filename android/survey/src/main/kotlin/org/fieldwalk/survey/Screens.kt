package org.fieldwalk.survey

import android.app.Activity
import android.content.Context
import android.view.View
import android.view.ViewGroup.LayoutParams.MATCH_PARENT
import android.view.ViewGroup.LayoutParams.WRAP_CONTENT
import android.widget.Button
import android.widget.LinearLayout
import android.widget.TextView

/** A row or column of views, built in code. */
internal fun Context.box(orientation: Int, vararg views: View) = LinearLayout(this).apply {
    this.orientation = orientation
    isBaselineAligned = false
    for (view in views) {
        val weight = (view.tag as? Float) ?: 0f
        val isRow = orientation == LinearLayout.HORIZONTAL
        val width = if (isRow) if (weight > 0) 0 else WRAP_CONTENT else MATCH_PARENT
        val height = if (isRow) MATCH_PARENT else if (weight > 0) 0 else WRAP_CONTENT
        addView(view, LinearLayout.LayoutParams(width, height, weight))
    }
}

/** A button that a thumb finds while walking. */
internal fun Activity.button(id: Int, label: String, pressed: () -> Unit) = Button(this).apply {
    this.id = id
    text = label
    contentDescription = label
    isAllCaps = false
    tag = 1f
    minHeight = (TOUCH_DP * resources.displayMetrics.density).toInt()
    setOnClickListener { pressed() }
}

internal fun Activity.label(id: Int, sizeSp: Float, isUrgent: Boolean = false) = TextView(this).apply {
    this.id = id
    textSize = sizeSp
    val margin = (6 * resources.displayMetrics.density).toInt()
    setPadding(margin, margin / 2, margin, margin / 2)
    if (isUrgent) accessibilityLiveRegion = View.ACCESSIBILITY_LIVE_REGION_POLITE
}

internal fun Activity.texts(): Texts = Texts.of(resources.configuration.locales[0])

/** Android's own advice is 48. */
private const val TOUCH_DP = 64
