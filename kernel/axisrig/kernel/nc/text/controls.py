"""Control structures, jumps and subprograms of the syntax tree, and the brackets of commands."""

from lark import Token, v_args

from axisrig.kernel.nc import syntax
from axisrig.kernel.nc.syntax import Number, Target
from axisrig.kernel.nc.text import nodes
from axisrig.kernel.nc.text.values import ExpressionBuilder, Part
from axisrig.kernel.nc.text.words import words

_TRUE = Number(1.0)


@v_args(inline=True)
class ControlBuilder(ExpressionBuilder):
    """Builds what is no word: control structures, calls, commands with their brackets."""

    def _control_word(self, token: Token) -> Token:
        """Note a word of a control structure that does not act."""
        spelled = token.upper()
        shown = "/" if token.type == "SKIP" else spelled.split()[0]
        kind = "control" if shown.startswith("$") else "sign"
        word = words(kind).get(shown)
        if word is not None and not word.acts:
            self.note(shown, word.meaning, self.at(token))
        return token

    IF = ELSEIF = ELSE = ENDIF = FOR = ENDFOR = WHILE = ENDWHILE = DO = ENDDO = _control_word
    REPEAT = UNTIL = SWITCH = CASE = DEFAULT = ENDSWITCH = BREAK = CONTINUE = _control_word
    GOTO = SKIP = CALL = _control_word

    def if_(self, _: Token, value: nodes.Value) -> syntax.If:
        """$IF."""
        return syntax.If(value.expression)

    def if_jump(self, _: Token, value: nodes.Value, __: Token, target: Target) -> syntax.Goto:
        """$IF condition $GOTO target."""
        return syntax.Goto(target, value.expression)

    def else_if(self, _: Token, value: nodes.Value) -> syntax.ElseIf:
        """$ELSEIF."""
        return syntax.ElseIf(value.expression)

    def else_(self, _: Token) -> syntax.Else:
        """$ELSE."""
        return syntax.Else()

    def end_if(self, _: Token) -> syntax.EndIf:
        """$ENDIF."""
        return syntax.EndIf()

    def for_(
        self,
        _: Token,
        variable: nodes.Value,
        first: nodes.Value,
        last: nodes.Value,
        step: nodes.Value,
    ) -> syntax.For:
        """$FOR."""
        if isinstance(step.expression, Number) and step.expression.value == 0:
            raise self.source.error(
                "a step of 0 never ends", step.offset, value="0", allowed="any other step"
            )
        assert isinstance(variable.expression, syntax.Variable)
        return syntax.For(variable.expression, first.expression, last.expression, step.expression)

    def end_for(self, _: Token) -> syntax.EndFor:
        """$ENDFOR."""
        return syntax.EndFor()

    def while_(self, _: Token, value: Part) -> syntax.While:
        """$WHILE; without condition it goes on for ever."""
        return syntax.While(_TRUE if value is None else value.expression)

    def end_while(self, _: Token) -> syntax.EndWhile:
        """$ENDWHILE."""
        return syntax.EndWhile()

    def do(self, _: Token) -> syntax.Do:
        """$DO."""
        return syntax.Do()

    def end_do(self, _: Token, value: Part) -> syntax.EndDo:
        """$ENDDO; without condition it goes on for ever."""
        return syntax.EndDo(_TRUE if value is None else value.expression)

    def repeat(self, _: Token) -> syntax.Repeat:
        """$REPEAT."""
        return syntax.Repeat()

    def until(self, _: Token, value: nodes.Value) -> syntax.Until:
        """$UNTIL."""
        return syntax.Until(value.expression)

    def switch(self, _: Token, value: nodes.Value) -> syntax.Switch:
        """$SWITCH."""
        return syntax.Switch(value.expression)

    def case(self, _: Token, value: nodes.Value) -> syntax.Case:
        """$CASE."""
        return syntax.Case(value.expression)

    def default(self, _: Token) -> syntax.Default:
        """$DEFAULT."""
        return syntax.Default()

    def end_switch(self, _: Token) -> syntax.EndSwitch:
        """$ENDSWITCH."""
        return syntax.EndSwitch()

    def break_(self, _: Token) -> syntax.Break:
        """$BREAK."""
        return syntax.Break()

    def continue_(self, _: Token) -> syntax.Continue:
        """$CONTINUE."""
        return syntax.Continue()

    # ---- jumps and calls

    def target(self, token: Token) -> Target:
        """Where a jump goes."""
        if token.type == "LABEL":
            return Target(f"[{token[1:-1].strip()}]")
        digits = token[1:].strip(" \t")
        if not digits.isdigit():
            raise self.source.error(
                "a jump needs a block number or a label in [ ]", self.at(token), value=str(token)
            )
        return Target(f"N{int(self.digits(digits, self.at(token)))}")

    def jump(self, token: Token, target: Target) -> nodes.Jump:
        """$GOTO."""
        return nodes.Jump(target, self.at(token))

    def subprogram(self, token: Token) -> nodes.Call:
        """LL name or L name."""
        word, _, name = token.partition(token[2] if token[1] in "Ll" else token[1])
        return nodes.Call(len(word) > 1, name.strip(' \t"'), None, self.at(token))

    def cycle(self, token: Token, bracket: nodes.Bracket) -> nodes.Call:
        """L CYCLE [NAME=.. @P1=..]."""
        return nodes.Call(token[1] in "Ll", "", bracket, self.at(token))

    # ---- brackets of commands

    def name(self, token: Token) -> nodes.Bare:
        """A word that is no expression."""
        return nodes.Bare(str(token), self.at(token))

    def keyword(self, token: Token, value: nodes.Value | nodes.Bare | nodes.Bracket) -> nodes.Entry:
        """KEYWORD=value."""
        return nodes.Entry(token.upper(), value, self.at(token))

    def plain(self, value: nodes.Value | nodes.Bare | nodes.Bracket) -> nodes.Entry:
        """A value or a keyword without `=`."""
        return nodes.Entry(None, value, value.offset)

    @v_args(inline=False)
    def element(self, entries: list[nodes.Entry]) -> tuple[nodes.Entry, ...]:
        """What is between two commas."""
        return tuple(entries)

    def bracket(self, token: Token, *elements: tuple[nodes.Entry, ...]) -> nodes.Bracket:
        """A whole bracket."""
        return nodes.Bracket(elements, self.at(token))

    def loose(self, *elements: tuple[nodes.Entry, ...]) -> nodes.Bracket:
        """Values of a command without brackets."""
        return nodes.Bracket(elements, elements[0][0].offset)

    @v_args(inline=False)
    def command(self, children: list[Part]) -> nodes.RawCommand:
        """A # command."""
        token, *brackets = children
        loose = None
        if token.type == "COMMAND" and brackets:
            loose, brackets = brackets[0], []
        words = tuple(token[1:].split())
        return nodes.RawCommand(words, tuple(brackets), loose, self.at(token))
