package org.fieldwalk.survey

import android.app.Activity
import android.app.AlertDialog
import android.content.Intent
import android.net.Uri
import android.os.Build
import android.os.Bundle
import android.text.Editable
import android.text.TextWatcher
import android.view.View
import android.view.WindowInsets
import android.widget.EditText
import android.widget.LinearLayout
import android.widget.ScrollView
import android.widget.TextView
import org.fieldwalk.ApiException
import org.fieldwalk.Surveyor
import org.fieldwalk.android.Permissions
import java.io.IOException
import java.text.DateFormat

/** Which floor is surveyed, on which plan; or which of the surveys on disk is continued. */
class StartActivity : Activity() {
    private lateinit var texts: Texts
    private lateinit var name: EditText
    private lateinit var number: TextView
    private lateinit var message: TextView
    private lateinit var surveys: LinearLayout

    /** What the surveyor chose; the name says it otherwise. */
    private var chosen: Int? = null
    private var named = ""
    private val ordinal get() = (chosen ?: floorOrdinal(floor)).coerceIn(FLOOR_ORDINALS)
    private val floor get() = name.text.toString().trim().ifEmpty { "F1" }

    override fun onCreate(saved: Bundle?) {
        setTheme(android.R.style.Theme_DeviceDefault_DayNight)
        super.onCreate(saved)
        texts = texts()
        title = texts.title
        chosen = saved?.getInt(ORDINAL, NONE)?.takeIf { it != NONE }
        name = EditText(this).apply {
            id = SurveyIds.FLOOR_NAME
            hint = texts.floorName
            setText(saved?.getString(NAME) ?: "F1")
            isSingleLine = true
            addTextChangedListener(object : TextWatcher {
                override fun beforeTextChanged(text: CharSequence?, start: Int, count: Int, after: Int) = Unit
                override fun onTextChanged(text: CharSequence?, start: Int, before: Int, count: Int) = Unit
                override fun afterTextChanged(text: Editable?) = name()
            })
        }
        number = label(SurveyIds.ORDINAL, 16f, isUrgent = true).apply { tag = 1f }
        message = label(SurveyIds.MESSAGE, 16f, isUrgent = true)
        surveys = box(LinearLayout.VERTICAL).apply { id = SurveyIds.SURVEYS }
        val rows = box(
            LinearLayout.VERTICAL,
            label(SurveyIds.SUMMARY, 24f).apply { text = texts.title },
            label(SurveyIds.ADVICE, 14f).apply {
                text = texts.floorName
                labelFor = SurveyIds.FLOOR_NAME
            },
            name,
            box(
                LinearLayout.HORIZONTAL,
                number,
                step(SurveyIds.LOWER, "−", texts.lowerFloor, -1),
                step(SurveyIds.HIGHER, "+", texts.higherFloor, 1),
            ),
            button(SurveyIds.CHOOSE_PLAN, texts.choosePlan, ::choosePlan).apply { tag = null },
            message,
            surveys,
        )
        setContentView(screen(ScrollView(this).apply { addView(rows) }))
        named = floor
        choose(chosen)
        requestPermissions(Permissions.forBeacons().toTypedArray(), 0)
    }

    override fun onResume() {
        super.onResume()
        list()
    }

    override fun onSaveInstanceState(state: Bundle) {
        super.onSaveInstanceState(state)
        state.putString(NAME, name.text.toString())
        state.putInt(ORDINAL, chosen ?: NONE)
    }

    @Deprecated("Android's own way without androidx")
    override fun onActivityResult(request: Int, result: Int, choice: Intent?) {
        val plan = choice?.data
        if (result == RESULT_OK && plan != null) open(plan)
    }

    private fun step(id: Int, sign: String, description: String, by: Int) =
        button(id, sign) { choose((ordinal + by).coerceIn(FLOOR_ORDINALS)) }.apply {
            contentDescription = description
            tag = null
        }

    /** Another name says another number; the same name, which Android sets anew when the screen turns, does not. */
    private fun name() {
        if (named != floor) choose(null)
        named = floor
    }

    private fun choose(ordinal: Int?) {
        chosen = ordinal
        number.text = texts.floorNumber(this.ordinal)
    }

    private fun choosePlan() {
        // Many apps that keep files know no type for GeoJSON.
        val choose = Intent(Intent.ACTION_OPEN_DOCUMENT).addCategory(Intent.CATEGORY_OPENABLE).setType("*/*")
        @Suppress("DEPRECATION") startActivityForResult(choose, 0)
    }

    private fun open(plan: Uri) {
        val bytes = try {
            contentResolver.openInputStream(plan)?.use { it.readBytes() } ?: ByteArray(0)
        } catch (_: IOException) {
            ByteArray(0)
        }
        try {
            Surveyor(bytes.toDirect(), floor, ordinal).close()
        } catch (_: ApiException) {
            message.text = texts.planUnreadable
            return
        }
        try {
            val survey = CurrentSurvey.create(this, bytes, floor, ordinal)
            message.text = ""
            go(survey)
        } catch (full: IOException) {
            message.text = texts.remedies.say(full)
        }
    }

    /** The surveys on disk, to go on with or to delete. */
    private fun list() {
        surveys.removeAllViews()
        for ((k, survey) in CurrentSurvey.all(this).withIndex()) {
            val locale = resources.configuration.locales[0]
            val begun = DateFormat.getDateTimeInstance(DateFormat.SHORT, DateFormat.SHORT, locale).format(survey.begun)
            val (go, delete) = SurveyIds.CONTINUE + k to SurveyIds.DELETE + k
            val label = texts.continueSurvey(survey.floor, survey.walks().size, begun)
            surveys.addView(
                box(
                    LinearLayout.HORIZONTAL,
                    button(go, label) { go(survey) },
                    button(delete, texts.delete) { confirm(survey) }.apply {
                        contentDescription = "${texts.delete}: ${survey.floor}"
                        tag = null
                    },
                ),
            )
        }
    }

    private fun confirm(survey: SurveyFolder) {
        AlertDialog.Builder(this)
            .setMessage(texts.reallyDelete(survey.floor, survey.walks().size, survey.isShared))
            .setNegativeButton(texts.keep, null)
            .setPositiveButton(texts.delete) { _, _ ->
                CurrentSurvey.delete(survey)
                list()
            }
            .show()
    }

    private fun go(survey: SurveyFolder) = startActivity(Intent(this, SurveyActivity::class.java).of(survey.name))

    private companion object {
        const val NAME = "name"
        const val ORDINAL = "ordinal"
        const val NONE = Int.MIN_VALUE
    }
}

/** A column that keeps clear of the bars that Android draws over it. */
internal fun Activity.screen(vararg views: View): LinearLayout =
    box(LinearLayout.VERTICAL, *views).apply {
        setOnApplyWindowInsetsListener { view, insets ->
            if (Build.VERSION.SDK_INT >= Build.VERSION_CODES.R) {
                val bars = insets.getInsets(WindowInsets.Type.systemBars() or WindowInsets.Type.displayCutout())
                view.setPadding(bars.left, bars.top, bars.right, bars.bottom)
            } else {
                @Suppress("DEPRECATION")
                view.setPadding(0, insets.systemWindowInsetTop, 0, insets.systemWindowInsetBottom)
            }
            insets
        }
    }
