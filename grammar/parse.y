/* parse.y: tokens to a tree of flat items.
 *
 * The grammar knows classes of words, never words, and every list of items
 * takes directives.  The scanner balances all brackets and tells comparisons
 * from vectors, so what is wrong here is wrong inside one list. */
%code requires {
#include "lang/parsing.h"

/* A value of the stacks is eight bytes: larger ones are written in parts and read
 * whole, for which processors wait. */
#define YYLTYPE struct loc
#define YYMAXDEPTH 30000
#define YYLLOC_DEFAULT(Current, Rhs, N) \
    ((Current) = (N) ? loc_join(YYRHSLOC(Rhs, 1), YYRHSLOC(Rhs, N)) : \
     (struct loc) { YYRHSLOC(Rhs, 0).source, YYRHSLOC(Rhs, 0).end, YYRHSLOC(Rhs, 0).end })
}

%define api.pure full
%define parse.lac full
%define parse.error custom
%locations
%union {
    double number;
    int op;
    struct name *word;
    struct ast *node;
}
%param { struct parse *p }
%expect 0

%code {
#include <ctype.h>
#include <string.h>

#include "lang/frame.h"

int scanner_next(YYSTYPE *value, YYLTYPE *at, struct parse *p);
#define yylex scanner_next
static void yyerror(YYLTYPE *at, struct parse *p, const char *message);
static struct ast *pending(struct parse *p);
static struct ast *take(struct ast *list, struct parse *p);
static struct ast *no_macro(struct parse *p, struct loc at, const struct name *name);
static bool statement(struct parse *p, struct ast *item, int ahead);
static struct ast *word_node(struct parse *p, struct loc at, struct name *w);
static struct ast *block_node(struct parse *p, struct loc at, struct name *w,
                              struct ast *body);
static struct ast *with_args(struct ast *node, struct ast *args);
static struct ast *with_body(struct ast *node, struct ast *body);
static struct ast *with_right(struct ast *node, struct ast *right);
static struct ast *with_name(struct ast *node, struct name *w);
static struct ast *with_op(struct ast *node, int op);
static struct ast *declaration(struct parse *p, struct loc at, int op, struct ast *marks,
                               struct ast *target, struct ast *value, int semicolon);
static struct ast *version_end(struct parse *p, int semicolons, int ahead, const YYSTYPE *value,
                               YYLTYPE at);
static struct ast *preceded(struct parse *p, struct ast *directive, struct ast *list);
static struct ast *branch(struct parse *p, struct loc at, int op, struct ast *condition,
                          struct ast *body);
static struct ast *of_one(struct parse *p, struct ast *item);
static int message_op(const struct word *word);
static struct ast *splice_node(struct parse *p, struct loc at, struct ast *directive);
}

%token YYEOF 0 "the end of the text"
%token <number> NUMBER "number"
%token <node> TEXT "text" CONSTANTS "number or vector"
%token <word> NAME "name" WORD "word" TEXTURE "texture" COLOUR "colour word"
    RGB "rgb" FUNC1 "function call" FUNC "function name" CONSTANT "constant" FUNCTION "function"
    ARRAY "array" MEMBER "component"
%token <node> BULK "numbers"
%token <node> BLOCK "block"
%token <op> COMPARE "comparison"
%token <node> BAD "unreadable characters"
%token <node> MISSING_BRACE "missing '}'" MISSING_PAREN "missing ')'"
    MISSING_BRACKET "missing ']'" MISSING_ANGLE "missing '>'" MISSING_END "missing '#end'"
%token DECLARE "#declare" LOCAL "#local" UNDEF "#undef" IF "#if" IFDEF "#ifdef"
    IFNDEF "#ifndef" ELSE "#else" ELSEIF "#elseif" END "#end" END_OPEN "#end behind '{'" WHILE "#while" FOR "#for"
    SWITCH "#switch" CASE "#case" RANGE "#range" BREAK "#break" MACRO "#macro"
    INCLUDE "#include" VERSION "#version" DEFAULT "#default" FOPEN "#fopen" FCLOSE "#fclose"
    READ "#read" WRITE "#write"
%token <word> MESSAGE "#debug"

%type <node> items item value cond logic rel sum prod unary postfix primary
    rsum rprod runary tail word_item directive quiet message splice vector args subscripts subscript
    braces brackets function array declare declared target marks colours textures
    branches branch_rest condition group body switch_items switch_item close_end macro_head parameters
    parameter target_in_parens for_head
%type <word> word any_word no_name
%type <op> sign semicolon

/* From loose to tight.  LOW: what could go on goes on; a sign behind an
 * operand is an operator, as in <1 -2 3>, which has two components. */
%precedence LOW
%precedence ';' '{' '[' NUMBER CONSTANTS TEXT NAME TEXTURE COLOUR RGB FUNC1 FUNC CONSTANT '!' '<' ARRAY WORD FUNCTION
    DECLARE LOCAL UNDEF IF IFDEF IFNDEF WHILE FOR SWITCH BREAK MACRO INCLUDE VERSION DEFAULT FOPEN FCLOSE
    READ WRITE MESSAGE '?' '&' '|'
%precedence COMPARE
%precedence '+' '-'
%precedence '*' '/' '('

%%

file: %empty
    | file item                     { if (!statement(p, $2, yychar)) YYACCEPT; }
    | file error                    { take(p->root, p); }
    ;

items: %empty                       { $$ = ast_list(p, @$); }
    | items item                    { $$ = ast_add($1, $2); }
    | items error                   { $$ = take($1, p); }
    ;

item: value                         { $$ = $1; }
    | tail                          { $$ = $1; }
    | word_item                     { $$ = $1; }
    | directive                     { $$ = $1; }
    | array                         { $$ = $1; }
    | function                      { $$ = $1; }
    | braces                        { $$ = with_body(ast_new(p, AST_BRACES, @1), $1); }
    | brackets                      { $$ = with_body(ast_new(p, AST_ENTRY, @1), $1); }
    | BULK                          { $$ = $1; }
    | BLOCK                         { $$ = $1; }        /* a word and plain braces */
    | ','                           { $$ = ast_new(p, AST_COMMA, @1); }
    | ':'                           { $$ = ast_new(p, AST_COLON, @1); }
    | ';'                           { $$ = ast_new(p, AST_SEMICOLON, @1); }
    | BAD                           { $$ = $1; }
    ;

value: cond %prec LOW               { $$ = $1; }
    | CONSTANTS                     { $$ = $1; };     /* no operator stands on either side */

/* --- words and brackets ---------------------------------------------------- */

word: WORD | TEXTURE | COLOUR | RGB | FUNC1 | FUNC;

word_item: word %prec LOW           { $$ = word_node(p, @1, $1); }
    | FUNCTION %prec LOW            { $$ = word_node(p, @1, $1); }
    | word braces                   { $$ = block_node(p, @1, $1, $2); }
    | NAME braces                   { $$ = block_node(p, @1, $1, $2); }
    ;

braces: '{' items close_brace       { $$ = ast_close(p, $2, @1, @3); };
brackets: '[' items close_bracket   { $$ = ast_close(p, $2, @1, @3); };
vector: '<' items close_angle       { $$ = ast_close(p, $2, @1, @3);
                                      if (p->lang->diag->lint)
                                          ast_check_commas(p, $$);
                                      ast_pack($$); };
args: '(' items close_paren         { $$ = ast_pack(ast_close(p, $2, @1, @3)); };
group: '(' items close_paren        { $$ = ast_pack(ast_close(p, $2, @1, @3)); };

close_brace: '}'                    { }
    | MISSING_BRACE                 { p->pending = $1; };
close_bracket: ']'                  { }
    | MISSING_BRACKET               { p->pending = $1; };
close_paren: ')'                    { }
    | MISSING_PAREN                 { p->pending = $1; };
close_angle: '>'                    { }
    | MISSING_ANGLE                 { p->pending = $1; };
close_end: END                      { $$ = NULL; }
    | MISSING_END                   { $$ = $1; p->unclosed = ast_add(p->unclosed, $1); };

/* --- expressions ----------------------------------------------------------- */

cond: logic %prec LOW               { $$ = $1; }
    | logic '?' cond ':' cond       { $$ = ast_condition(p, @$, $1, $3, $5); };

logic: rel %prec LOW                { $$ = $1; }
    | logic '&' rel %prec LOW       { $$ = ast_binary(p, @$, '&', $1, $3); }
    | logic '|' rel %prec LOW       { $$ = ast_binary(p, @$, '|', $1, $3); };

rel: sum %prec LOW                  { $$ = $1; }
    | rel COMPARE rsum              { $$ = ast_binary(p, @$, $2, $1, $3); };

sum: prod %prec LOW                 { $$ = $1; }
    | sum '+' rprod                 { $$ = ast_binary(p, @$, '+', $1, $3); }
    | sum '-' rprod                 { $$ = ast_binary(p, @$, '-', $1, $3); };

prod: unary                         { $$ = $1; }
    | prod '*' runary               { $$ = ast_binary(p, @$, '*', $1, $3); }
    | prod '/' runary               { $$ = ast_binary(p, @$, '/', $1, $3); };

unary: postfix                      { $$ = $1; }
    | sign runary                   { $$ = ast_unary(p, @$, $1, $2); };

sign: '+' { $$ = '+'; } | '-' { $$ = '-'; } | '!' { $$ = '!'; };

/* Behind an operator a directive may bring the operand. */
rsum: rprod %prec LOW               { $$ = $1; }
    | rsum '+' rprod                { $$ = ast_binary(p, @$, '+', $1, $3); }
    | rsum '-' rprod                { $$ = ast_binary(p, @$, '-', $1, $3); };

rprod: runary                       { $$ = $1; }
    | rprod '*' runary              { $$ = ast_binary(p, @$, '*', $1, $3); }
    | rprod '/' runary              { $$ = ast_binary(p, @$, '/', $1, $3); };

runary: unary                       { $$ = $1; }
    | splice                        { $$ = splice_node(p, @1, $1); }
    | quiet runary                  { $$ = splice_node(p, @$, $1); ast_add($$->first, $2); }
    | quiet %prec LOW               { $$ = splice_node(p, @1, $1); };

/* Its left side comes from before a directive: (1 #if (A) * 2 #end). */
tail: '*' runary %prec LOW          { $$ = ast_tail(p, @$, '*', $2); }
    | '/' runary %prec LOW          { $$ = ast_tail(p, @$, '/', $2); }
    | COMPARE rsum %prec LOW        { $$ = ast_tail(p, @$, $1, $2); };

postfix: primary %prec LOW          { $$ = $1; }
    | primary '.' MEMBER            { $$ = ast_member(p, @$, $1, $3->text); };

primary: NUMBER                     { $$ = ast_new(p, AST_NUMBER, @1); $$->number = $1; }
    | TEXT                          { $$ = $1; }
    | NAME %prec LOW                { $$ = with_name(ast_new(p, AST_NAME, @1), $1); }
    | NAME subscripts %prec LOW     { $$ = with_args(with_name(ast_new(p, AST_INDEX, @$), $1), $2); }
    | NAME args                     { $$ = with_args(with_name(ast_new(p, AST_CALL, @$), $1), $2); }
    | NAME subscripts args          { $$ = with_args(with_name(ast_new(p, AST_CALL, @$), $1), $3);
                                      $$->params = $2; }
    | FUNC1 args                    { $$ = with_args(with_name(ast_new(p, AST_FUNC, @$), $1), $2); }
    | FUNC args                     { $$ = with_args(with_name(ast_new(p, AST_FUNC, @$), $1), $2); }
    | CONSTANT                      { $$ = with_name(ast_new(p, AST_CONSTANT, @1), $1); }
    | vector                        { $$ = with_args(ast_new(p, AST_VECTOR, @1), $1); }
    | group                         { $$ = with_args(ast_new(p, AST_PAREN, @1), $1); }
    ;

subscripts: subscript               { $$ = of_one(p, $1); }
    | subscripts subscript          { $$ = ast_add($1, $2); };
subscript: '[' items close_bracket  { $$ = ast_pack(ast_close(p, $2, @1, @3)); };

array: ARRAY subscripts %prec LOW   { $$ = with_args(ast_new(p, AST_ARRAY, @1), $2); }
    | ARRAY subscripts braces       { $$ = with_body(with_args(ast_new(p, AST_ARRAY, @1), $2), $3); };

function: FUNCTION braces           { $$ = with_body(ast_new(p, AST_FUNCTION, @1), $2); }
    | FUNCTION '(' parameters ')' braces
                                    { $$ = with_body(ast_new(p, AST_FUNCTION, @1), $5);
                                      $$->params = $3; };

/* --- directives -------------------------------------------------------------- */

directive: quiet %prec LOW          { $$ = $1; }
    | splice                        { $$ = $1; }
    ;

/* These leave nothing behind in the list ... */
quiet: declare
    | UNDEF target                  { $$ = ast_new(p, AST_UNDEF, @$); $$->target = $2; }
    | MACRO macro_head items close_end
                                    { $$ = with_body($2, ast_close(p, $3, @1, @4)); }
    | VERSION sum semicolon         { $$ = with_right(ast_new(p, AST_VERSION, @1), $2);
                                      $$->flags |= $3 ? AST_SEMI : 0;
                                      $$->third = version_end(p, $3, yychar, &yylval, yylloc); }
    | DEFAULT braces                { $$ = with_body(ast_new(p, AST_DEFAULT, @1), $2); }
    | MESSAGE message               { $$ = with_right(with_op(ast_new(p, AST_MESSAGE, @1),
                                                              message_op($1->word)), $2); }
    | FOPEN NAME postfix word       { $$ = with_name(ast_new(p, AST_FOPEN, @1), $2);
                                      $$->word = $4->word; $$->args = of_one(p, $3); }
    | FOPEN NAME postfix NAME       { $$ = ast_error(p, @4, (struct loc) { 0 }, "expected read, write "
                                                     "or append, found '%s'", $4->text);
                                      ast_more(p, $$)->meant = $2; }
    | FCLOSE any_word               { $$ = with_name(ast_new(p, AST_FCLOSE, @1), $2); }
    | FCLOSE NUMBER                 { $$ = ast_new(p, AST_FCLOSE, @1); }
    | FCLOSE TEXT                   { $$ = ast_new(p, AST_FCLOSE, @1); }
    | FCLOSE %prec LOW              { $$ = ast_new(p, AST_FCLOSE, @1); }
    | READ args                     { $$ = with_args(ast_new(p, AST_READ, @1), $2); }
    | WRITE args                    { $$ = with_args(ast_new(p, AST_WRITE, @1), $2); }
    | BREAK                         { $$ = ast_new(p, AST_BREAK, @1); }
    ;

message: postfix %prec LOW          { $$ = $1; }
    | splice                        { $$ = splice_node(p, @1, $1); }
    | quiet message                 { $$ = splice_node(p, @$, $1); ast_add($$->first, $2); }
    | quiet %prec LOW               { $$ = splice_node(p, @1, $1); }
    ;

/* ... and these may leave items. */
splice: branches close_end          { $$ = ast_close(p, $1, $1->at, @2); $$->kind = AST_IF; }
    | branches END_OPEN items close_brace
                                    { ast_share(p, $1, ast_close(p, $3, @2, @4));
                                      $$ = ast_close(p, $1, $1->at, @4); $$->kind = AST_IF; }
    | WHILE condition body          { $$ = with_body(with_args(ast_new(p, AST_WHILE, @1), $2), $3); }
    | FOR for_head body             { $$ = with_body($2, $3); $$->at = @1; }
    | SWITCH condition switch_items close_end
                                    { $$ = with_body(with_args(ast_new(p, AST_SWITCH, @1), $2),
                                                     ast_close(p, $3, @1, @4)); }
    | INCLUDE postfix %prec LOW     { $$ = with_right(ast_new(p, AST_INCLUDE, @1), $2); }
    ;

declare: DECLARE marks target '=' declared semicolon
                                    { $$ = declaration(p, @1, 'd', $2, $3, $5, $6); }
    | LOCAL marks target '=' declared semicolon
                                    { $$ = declaration(p, @1, 'l', $2, $3, $5, $6); }
    | DECLARE marks '=' declared semicolon
                                    { $$ = declaration(p, @1, 'd', $2, NULL, $4, $5); }
    | LOCAL marks '=' declared semicolon
                                    { $$ = declaration(p, @1, 'l', $2, NULL, $4, $5); }
    ;

/* deprecated once "text"; any other word there is one that cannot be declared. */
marks: %empty                       { $$ = NULL; }
    | marks word                    { $$ = ast_add($1 ? $1 : ast_list(p, @2), word_node(p, @2, $2)); }
    | marks CONSTANT                { $$ = ast_add($1 ? $1 : ast_list(p, @2), word_node(p, @2, $2)); }
    | marks TEXT                    { $$ = ast_add($1 ? $1 : ast_list(p, @2), $2); }
    ;

target: NAME %prec LOW              { $$ = with_name(ast_new(p, AST_NAME, @1), $1); }
    | NAME subscripts %prec LOW     { $$ = with_args(with_name(ast_new(p, AST_INDEX, @$), $1), $2); }
    ;

declared: value                     { $$ = of_one(p, $1); }
    | array                         { $$ = of_one(p, $1); }
    | function                      { $$ = of_one(p, $1); }
    | splice                        { $$ = of_one(p, $1); }
    | WORD braces                   { $$ = of_one(p, block_node(p, @1, $1, $2)); }
    | WORD value                    { $$ = ast_add(of_one(p, word_node(p, @1, $1)), $2); }
    | NAME braces                   { $$ = of_one(p, block_node(p, @1, $1, $2)); }
    | colours %prec LOW
    | textures %prec LOW
    | quiet declared                { $$ = preceded(p, $1, $2); }
    | quiet %prec LOW               { $$ = of_one(p, $1); }
    ;

colours: COLOUR %prec LOW           { $$ = of_one(p, word_node(p, @1, $1)); }
    | RGB value                     { $$ = ast_add(of_one(p, word_node(p, @1, $1)), $2); }
    | COLOUR value                  { $$ = ast_add(of_one(p, word_node(p, @1, $1)), $2); }
    | colours RGB value             { $$ = ast_add(ast_add($1, word_node(p, @2, $2)), $3); }
    | colours COLOUR value          { $$ = ast_add(ast_add($1, word_node(p, @2, $2)), $3); }
    ;

textures: TEXTURE braces            { $$ = of_one(p, block_node(p, @1, $1, $2)); }
    | textures TEXTURE braces       { $$ = ast_add($1, block_node(p, @2, $2, $3)); }
    ;

semicolon: %empty %prec LOW         { $$ = 0; }
    | ';' %prec LOW                 { $$ = 1; }
    | ';' ';'                       { $$ = 2; }
    ;

condition: group                    { $$ = $1; }
    | error                         { $$ = take(ast_list(p, @1), p); }
    ;
body: items close_end               { $$ = ast_close(p, $1, @1, @2);
                                      $$->flags &= $2 ? ~AST_CLOSED : ~0; };

branches: IF condition items        { $$ = of_one(p, branch(p, @1, 'i', $2, $3)); }
    | IFDEF target_in_parens items  { $$ = of_one(p, branch(p, @1, 'd', $2, $3)); }
    | IFNDEF target_in_parens items { $$ = of_one(p, branch(p, @1, 'n', $2, $3)); }
    | branches branch_rest          { $$ = ast_add($1, $2); }
    ;
branch_rest: ELSEIF condition items { $$ = branch(p, @1, 'i', $2, $3); }
    | ELSE items                    { $$ = branch(p, @1, 'i', NULL, $2); }
    ;
target_in_parens: '(' target close_paren    { $$ = take(of_one(p, $2), p); }
    | '(' no_name close_paren       { $$ = take(of_one(p, word_node(p, @2, $2)), p); }
    | '(' NUMBER close_paren        { $$ = take(of_one(p, ast_new(p, AST_NUMBER, @2)), p); }
    | '(' CONSTANTS close_paren     { $$ = take(of_one(p, $2), p); }
    | '(' TEXT close_paren          { $$ = take(of_one(p, $2), p); }
    | error                         { $$ = take(ast_list(p, @1), p); }
    ;
no_name: word | CONSTANT | FUNCTION | ARRAY;
any_word: no_name | NAME;

for_head: '(' NAME items close_paren
                                    { $$ = with_args(with_name(ast_new(p, AST_FOR, @2), $2),
                                                     ast_close(p, $3, @1, @4)); }
    | error                         { $$ = with_args(ast_new(p, AST_FOR, @1),
                                                     take(ast_list(p, @1), p)); }
    ;

switch_items: %empty                { $$ = ast_list(p, @$); }
    | switch_items switch_item      { $$ = ast_add($1, $2); }
    | switch_items error            { $$ = take($1, p); }
    ;
switch_item: item
    | CASE condition                { $$ = with_op(with_args(ast_new(p, AST_CASE, @1), $2), 'c'); }
    | RANGE args                    { $$ = with_op(with_args(ast_new(p, AST_CASE, @1), $2), 'r'); }
    | ELSE                          { $$ = with_op(ast_new(p, AST_CASE, @1), 'e'); }
    ;

macro_head: NAME '(' parameters close_paren
                                    { $$ = with_name(ast_new(p, AST_MACRO, @1), $1);
                                      $$->params = $3; $$->args = pending(p); }
    | any_word error                { $$ = ast_new(p, AST_MACRO, @1); $$->args = no_macro(p, @1, $1); }
    | error                         { $$ = ast_new(p, AST_MACRO, @1); $$->args = pending(p); }
    ;
parameters: %empty                  { $$ = ast_list(p, @$); }
    | parameters parameter          { $$ = ast_add($1, $2); }
    | parameters ','                { $$ = ast_add($1, ast_new(p, AST_COMMA, @2)); }
    ;
parameter: NAME                     { $$ = with_name(ast_new(p, AST_NAME, @1), $1); }
    | CONSTANT                      { $$ = with_name(ast_new(p, AST_CONSTANT, @1), $1); }
    | word                          { $$ = word_node(p, @1, $1); }
    ;

%%

static struct ast *pending(struct parse *p)
{
    struct ast *message = p->pending;

    p->pending = NULL;
    return message;
}

/* #macro sphere(R): whatever was wrong behind the word, the word comes first. */
static struct ast *no_macro(struct parse *p, struct loc at, const struct name *name)
{
    struct ast *said = pending(p);

    return name->word ? ast_error(p, at, (struct loc) { 0 }, "'%s' is a reserved word: it cannot be "
                                  "declared", name->text) : said;
}

static struct ast *take(struct ast *list, struct parse *p)
{
    return ast_add(list, pending(p));
}

static struct ast *with_name(struct ast *node, struct name *w)
{
    node->name = w;
    node->word = w ? w->word : NULL;
    return node;
}

static struct ast *word_node(struct parse *p, struct loc at, struct name *w)
{
    return with_name(ast_new(p, AST_WORD, at), w);
}

static struct ast *with_args(struct ast *node, struct ast *args)
{
    node->args = args;
    if (node->kind == AST_CALL)
        node->flags |= AST_HAS_CALL;
    return node;
}

static struct ast *with_body(struct ast *node, struct ast *body)
{
    node->body = body;
    return node;
}

static struct ast *block_node(struct parse *p, struct loc at, struct name *w,
                              struct ast *body)
{
    return with_body(with_name(ast_new(p, AST_BLOCK, at), w), body);
}

static struct ast *with_right(struct ast *node, struct ast *right)
{
    node->right = right;
    return node;
}

static struct ast *with_op(struct ast *node, int op)
{
    node->op = (uint8_t)op;
    return node;
}

static struct ast *of_one(struct parse *p, struct ast *item)
{
    return ast_pack(ast_add(ast_list(p, item->at), item));
}

/* What POV-Ray refuses right behind #version 3.7; NULL: all is well. */
static struct ast *version_end(struct parse *p, int semicolons, int ahead, const YYSTYPE *value,
                               YYLTYPE at)
{
    if (semicolons > 1)
        return ast_error(p, at, (struct loc) { 0 }, "one ';' ends #version");
    if (semicolons || ahead != NAME || !value->word->slot || !is_macro(value->word))
        return NULL;
    return ast_error(p, at, (struct loc) { 0 }, "';' is missing between #version and this macro");
}

/* A declaration's value with a directive before it. */
static struct ast *preceded(struct parse *p, struct ast *directive, struct ast *list)
{
    struct ast *all = ast_add(ast_list(p, directive->at), directive);

    if (list->first) {
        ast_add(all, list->first);
        all->last = list->last;
    }
    return all;
}

static struct ast *splice_node(struct parse *p, struct loc at, struct ast *directive)
{
    struct ast *node = ast_new(p, AST_SPLICE, at);

    node->first = of_one(p, directive);
    node->flags |= AST_HAS_CALL;
    return node;
}

static int message_op(const struct word *word)
{
    return word->text[0];
}

static struct ast *declaration(struct parse *p, struct loc at, int op, struct ast *marks,
                               struct ast *target, struct ast *value, int semicolon)
{
    struct ast *node = with_op(ast_new(p, AST_DECLARE, at), op);

    node->marks = marks;
    node->target = target;
    node->value = value;
    if (semicolon)
        node->flags |= AST_SEMI;
    node->n = (uint16_t)semicolon;
    return node;
}

static struct ast *branch(struct parse *p, struct loc at, int op, struct ast *condition,
                          struct ast *body)
{
    struct ast *node = with_op(ast_new(p, AST_BRANCH, at), op);

    node->args = condition;
    node->body = body;
    return node;
}

/* The name that stands right before a place; NULL: something else does. */
static struct name *name_before(struct parse *p, struct loc *at)
{
    const char *end = p->text + at->begin;

    while (end > p->text && (end[-1] == ' ' || end[-1] == '\t'))
        end--;
    const char *begin = end;
    while (begin > p->text && (isalnum((unsigned char)begin[-1]) || begin[-1] == '_'))
        begin--;
    struct name *name = name_intern(&p->lang->names, begin, (size_t)(end - begin));
    if (begin == end || isdigit((unsigned char)*begin) || name->word)
        return NULL;
    at->begin = (uint32_t)(begin - p->text);
    at->end = (uint32_t)(end - p->text);
    return name;
}

/* #for (I = 0; ... */
static bool is_for_head(const struct parse *p, struct loc at)
{
    const char *text = p->text + at.begin;

    while (text > p->text && (text[-1] == ' ' || text[-1] == '('))
        text--;
    return text - p->text > 4 && strncmp(text - 3, "for", 3) == 0;
}

/* `R = 1;` as in other languages. */
static struct ast *assignment(struct parse *p, struct loc at)
{
    struct loc sign = at;
    struct name *name = name_before(p, &at);
    struct ast *error;

    if (name && is_for_head(p, at))
        return ast_error(p, sign, (struct loc) { 0 }, "unexpected '='; #for takes a name, a start, "
                         "an end and perhaps a step: #for (%s, 0, 9)", name->text);
    if (!name)
        return ast_error(p, at, (struct loc) { 0 },
                         "unexpected '='; a name gets its value with #declare NAME = VALUE;");
    error = ast_error(p, at, (struct loc) { 0 }, "'%s' gets its value with a directive: "
                      "#declare %s = VALUE;", name->text, name->text);
    ast_more(p, error)->meant = name;
    return error;
}

/* What other languages write twice, ours writes once. */
static struct ast *doubled(struct parse *p, struct loc at, char sign)
{
    const char *means = sign == '=' ? "equality" : sign == '&' ? "'and'" : "'or'";

    return ast_error(p, at, (struct loc) { 0 }, "unexpected '%c'; %s is a single '%c'", sign, means,
                     sign);
}

static bool is_doubled(const struct parse *p, struct loc at)
{
    const char *text = p->text + at.begin;

    return strchr("=&|", *text) && at.begin > 0 && text[-1] == *text;
}

/* The name behind #declare or #local is known from now on. */
static void mean_declared(struct parse *p)
{
    if (p->declaring.source)
        ast_more(p, p->pending)->meant = name_behind(p, p->declaring.end);
    p->declaring.source = 0;
}

enum { MOST_EXPECTED = 3 };

/* The tokens that stand for what the user forgot are none that could be written. */
static int without_missing(yysymbol_kind_t *kind, int n)
{
    int kept = 0;

    for (int i = 0; i < n; i++)
        if (kind[i] < YYSYMBOL_MISSING_BRACE || kind[i] > YYSYMBOL_MISSING_END)
            kind[kept++] = kind[i];
    return kept;
}

static bool ends_body(yysymbol_kind_t token)
{
    return token == YYSYMBOL_ELSE || token == YYSYMBOL_ELSEIF || token == YYSYMBOL_END
        || token == YYSYMBOL_END_OPEN || token == YYSYMBOL_CASE || token == YYSYMBOL_RANGE;
}

/* Directives are carried out wherever POV-Ray reads a token that is no name to be made. */
static bool is_late(const struct parse *p, yysymbol_kind_t token, struct loc at)
{
    bool names = p->declaring.source && p->declaring.begin != at.begin;

    return token >= YYSYMBOL_DECLARE && token <= YYSYMBOL_MESSAGE && !names && !ends_body(token)
        && p->before != DECLARE && p->before != LOCAL && p->before != UNDEF && p->before != MACRO
        && p->before != ARRAY && p->before != VERSION && p->before != '.';
}

/* "unexpected '='; expected number or name" when few things would do. */
static int yyreport_syntax_error(const yypcontext_t *context, struct parse *p)
{
    yysymbol_kind_t expected[MOST_EXPECTED + 2];
    struct loc at = *yypcontext_location(context);
    yysymbol_kind_t token = yypcontext_token(context);
    int n = yypcontext_expected_tokens(context, expected, MOST_EXPECTED + 2);
    char text[200];
    size_t used = 0;

    if (p->deep || token == YYSYMBOL_BAD)       /* which has a message of its own */
        return 0;
    n = without_missing(expected, n < MOST_EXPECTED + 2 ? n : MOST_EXPECTED + 2);
    for (int i = 0; i < n && n <= MOST_EXPECTED && used < sizeof text; i++)
        used += (size_t)snprintf(text + used, sizeof text - used, "%s %s",
                                 i ? i + 1 == n ? " or" : "," : "; expected",
                                 yysymbol_name(expected[i]));
    scanner_uncover(p);
    const char *source = p->text + at.begin;
    int length = (int)(at.end - at.begin);
    if (token == YYSYMBOL_YYEOF)
        p->pending = ast_error(p, at, (struct loc) { 0 }, "unexpected end of the text%s",
                               used ? text : "");
    else if (is_doubled(p, at))
        p->pending = doubled(p, at, *source);
    else if (*source == '=' && !p->declaring.source)
        p->pending = assignment(p, at);
    else
        p->pending = ast_error(p, at, (struct loc) { 0 }, "unexpected '%.*s'%s",
                               length < 40 ? length : 40, source, used ? text : "");
    if (is_late(p, token, at))
        p->pending->op = AST_ERROR_LATE;
    mean_declared(p);
    return 0;
}

/* Only when the parser's stack is full. */
static void yyerror(YYLTYPE *at, struct parse *p, const char *message)
{
    (void)message;
    if (!p->deep)
        lang_limit(p->lang, *at, "nested too deeply");
    p->deep = true;
}

/* --- the top level ------------------------------------------------------------ */

/* Words, names and values may belong to what follows, a message may make the
 * next items meaningless. */
static bool may_run(const struct parse *p, const struct ast *item)
{
    return item->kind == AST_BLOCK || item->kind >= AST_DECLARE
        || (item->kind == AST_CALL && p->root->first == item);
}

/* The token that was looked at already may have a node, in memory that is not
 * to be used again. */
static void forget(struct parse *p, int ahead)
{
    bool has_node = ahead == TEXT || ahead == CONSTANTS || ahead == BULK || ahead == BLOCK || ahead == BAD
        || (ahead >= MISSING_BRACE && ahead <= MISSING_END);

    p->root->first = p->root->last = NULL;
    if (!p->keep && !has_node)
        arena_recycle(p->mem, p->mark);
    p->mark = arena_mark(p->mem);
    p->keep = ahead == MACRO || ahead == FUNCTION || has_node;
}

/* False: nothing more shall be read. */
static bool statement(struct parse *p, struct ast *item, int ahead)
{
    ast_add(p->root, item);
    if (!p->run || !may_run(p, item))
        return true;
    scanner_uncover(p);
    p->run(p->lang, p->root);
    forget(p, ahead);
    return !p->lang->stopped && !p->rest_taken;
}

struct parse *parse_start(struct lang *l, uint32_t source)
{
    const struct source *text = source_at(l->sources, source);
    struct parse *p = arena_alloc(l->mem, sizeof *p);

    *p = (struct parse) { .lang = l, .mem = l->mem, .source = source, .text = (char *)text->text,
                          .size = text->size };
    p->open = arena_array(l->mem, l->limits->nesting + 1, sizeof *p->open);
    if (p->size >= 3 && memcmp(p->text, "\xef\xbb\xbf", 3) == 0 && !text->included_at.source)
        memset(p->text, ' ', 3);            /* a mark that some editors write */
    return scanner_start(p) ? p : NULL;
}

static void parse_all(struct parse *p)
{
    uint32_t end = (uint32_t)p->size;

    p->root = ast_list(p, (struct loc) { 0 });
    p->root->close = (struct loc) { p->source, end, end };
    p->unclosed = ast_list(p, p->root->close);
    p->mark = arena_mark(p->mem);
    yyparse(p);
    scanner_end(p);
    ast_add(p->root, pending(p));
    ast_add(p->root, p->unclosed->first);       /* #ends that are missing are missed at the end */
}

struct ast *parse_source(struct lang *l, uint32_t source)
{
    struct parse *p = parse_start(l, source);

    parse_all(p);
    return p->root;
}

void parse_and_run(struct lang *l, uint32_t source,
                   void (*run)(struct lang *l, const struct ast *statements))
{
    struct parse *p = parse_start(l, source);

    p->mem = &l->statements;
    p->run = run;
    l->streamed = p;
    parse_all(p);
    l->streamed = NULL;
    run(l, p->root);
}

void scanner_dump(struct lang *l, uint32_t source, FILE *out)
{
    struct parse *p = parse_start(l, source);
    YYSTYPE value;
    struct loc at;

    p->every_token = true;
    for (int token; (token = scanner_next(&value, &at, p)) != YYEOF;) {
        struct position from = source_position(l->sources, source, at.begin);
        const char *name = yysymbol_name(YYTRANSLATE(token));
        int length = (int)(at.end - at.begin), place;
        fprintf(out, "%u:%u%n", from.line, from.column, &place);
        fprintf(out, "%*s  %-16s  %.*s\n", place < 8 ? 8 - place : 0, "",
                *name == '\'' ? "" : name, length < 60 ? length : 60, p->text + at.begin);
    }
    scanner_end(p);
}
